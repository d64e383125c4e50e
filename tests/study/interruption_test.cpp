// A Progress that throws Interrupted ends a study early; what is finished is kept, and is what it would have
// been.
#include <atomic>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "study/engine_comparison.h"
#include "study/tune.h"

namespace crossgait {
namespace {

EnvConfig short_episodes() {
  EnvConfig config;
  config.engine = available_engines().front();
  config.episode_seconds = 0.1;
  config.settle_seconds = 0.1;
  config.adapt = {"step_length"};
  return config;
}

// Lets through a share of the job.
Progress until(double limit) {
  return [limit](double share) {
    if (share >= limit) throw Interrupted();
  };
}

TEST(Interruptions, LeaveTheEpisodesThatAreFinished) {
  const EpisodeOptions options{.episodes = 8, .workers = 1, .seed = 3};
  const Rollout whole = roll_out(short_episodes(), {"random", "zero"}, options);
  const Rollout part = roll_out(short_episodes(), {"random", "zero"}, options, until(0.7));
  EXPECT_FALSE(whole.interrupted);
  EXPECT_TRUE(part.interrupted);
  ASSERT_EQ(part.policies.size(), 2U);
  EXPECT_EQ(to_json(part.policies[0].all), to_json(whole.policies[0].all));
  ASSERT_EQ(part.policies[1].episodes.size(), 4U);  // of 16, the twelfth reaches 0.7
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_EQ(to_json(part.policies[1].episodes[k]), to_json(whole.policies[1].episodes[k]));
}

TEST(Interruptions, LeaveTheCellsThatAreFinished) {
  const EpisodeOptions options{.episodes = 2, .workers = 1, .seed = 3};
  const std::vector<std::string> engine{short_episodes().engine};
  const Transfer part =
      transfer_policy(short_episodes(), "zero", engine, {"flat", "rough", "waves"}, options, until(0.5));
  EXPECT_TRUE(part.interrupted);
  ASSERT_EQ(part.cells.size(), 1U);
  EXPECT_EQ(part.cells[0].terrain, "flat");
  EXPECT_FALSE(describe(part).empty());
}

// An evaluation of one episode is finished whenever it says how far it is.
TEST(Interruptions, ComeBetweenEvaluationsToo) {
  const EpisodeOptions options{.episodes = 1, .workers = 2, .seed = 3};
  const Rollout rollout = roll_out(short_episodes(), {"zero", "random", "zero"}, options, until(0.3));
  EXPECT_TRUE(rollout.interrupted);
  EXPECT_EQ(rollout.policies.size(), 1U);
  const Transfer transfer = transfer_policy(short_episodes(), "zero", {short_episodes().engine},
                                            {"flat", "rough", "waves"}, options, until(0.3));
  EXPECT_TRUE(transfer.interrupted);
  EXPECT_EQ(transfer.cells.size(), 1U);
}

TEST(Interruptions, LeaveTheBestSoFar) {
  const TuneOptions options{
      .iterations = 3, .population = 4, .terrains = 1, .unseen = 1, .workers = 2, .seed = 1};
  const Tuning part = tune_gait(short_episodes(), {short_episodes().engine}, options, until(0.5));
  EXPECT_TRUE(part.interrupted);
  EXPECT_EQ(part.history.size(), 1U);
  EXPECT_TRUE(part.checks.empty());
  EXPECT_EQ(to_json(part)["interrupted"], true);
}

TEST(Interruptions, OfAVerdictMakeNoMoreRuns) {
  if (available_engines().size() < 2) GTEST_SKIP() << "one engine alone";
  Behaviour behaviour;
  behaviour.statistics = {{"nothing", "nothing", "-", {0, 1, false, ""}}};
  behaviour.seconds = 1;
  behaviour.cut_dt = 2e-3;
  behaviour.physics_dt = 1e-3;
  behaviour.control_dt = 2e-3;
  std::atomic<int> runs = 0;
  behaviour.run = [&runs](const Engine&, const Variation&, std::size_t, double) {
    ++runs;
    return BehaviourRun{{0}, Outcome::kWalked, 1};
  };
  const std::vector<Engine> engines{find_engine(available_engines().front()),
                                    find_engine(available_engines().back())};
  const VerdictOptions options{.starts = 100, .workers = 2};
  EXPECT_THROW((void)reach_verdicts(behaviour, engines, options, until(0)), Interrupted);
  EXPECT_LE(runs, 2);  // what each worker was at
}

}  // namespace
}  // namespace crossgait
