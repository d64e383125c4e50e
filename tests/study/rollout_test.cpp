#include "study/rollout.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "study/tune.h"
#include "tests/support/engine_test.h"
#include "tests/support/motion_bits.h"

namespace crossgait {
namespace {

EnvConfig short_episodes(const std::string& engine) {
  EnvConfig c;
  c.engine = engine;
  c.terrain = "rough:size_x=3,size_y=3";
  c.episode_seconds = 0.4;
  c.settle_seconds = 0.1;
  c.randomisation[Randomised::kStartYaw] = {-1, 1};
  return c;
}

/// Shares that only grow, up to 1.
Progress watched(std::vector<double>& shares) {
  return [&shares](double share) { shares.push_back(share); };
}

void expect_to_the_end(const std::vector<double>& shares) {
  ASSERT_FALSE(shares.empty());
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_DOUBLE_EQ(shares.back(), 1);
}

class Studies : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(Studies);

TEST_P(Studies, RolloutsDoNotHangOnThreads) {
  const EnvConfig config = short_episodes(GetParam());
  std::vector<double> shares;
  const Rollout one = roll_out(config, {"random", "zero"}, {.episodes = 5, .workers = 1, .seed = 3});
  const Rollout three =
      roll_out(config, {"random", "zero"}, {.episodes = 5, .workers = 3, .seed = 3}, watched(shares));
  EXPECT_EQ(to_json(one).dump(), to_json(three).dump());
  expect_to_the_end(shares);
  ASSERT_EQ(one.policies.size(), 2U);
  for (const PolicyEpisodes& run : one.policies) {
    ASSERT_EQ(run.episodes.size(), 5U);
    EXPECT_EQ(to_json(run.all), to_json(sum_up(run.episodes)));
  }
  // Both policies meet the same worlds.
  for (std::size_t k = 0; k < 5; ++k)
    EXPECT_EQ(one.policies[0].episodes[k].seed, one.policies[1].episodes[k].seed);
  EXPECT_NE(to_json(one), to_json(roll_out(config, {"random", "zero"}, {.episodes = 5, .seed = 4})));
}

TEST_P(Studies, TheTraceOfAPolicyIsItsFirstEpisode) {
  const EnvConfig config = short_episodes(GetParam());
  const Rollout rollout = roll_out(config, {"random"}, {.episodes = 1, .workers = 1, .seed = 3});
  TraceRecorder recorder;
  record_episode(config, "random", 3, recorder);
  const Trace trace = recorder.take();
  EXPECT_EQ(trace.size(), 200U);
  EXPECT_EQ(trace.back().state.p_WB, rollout.policies[0].episodes[0].motion.final_position_m);
  EXPECT_EQ(trace.back().parameters->step_length, rollout.policies[0].episodes[0].parameters->step_length);
}

TEST_P(Studies, TransferIsTheRolloutOfEveryCell) {
  const EnvConfig config = short_episodes(GetParam());
  const EpisodeOptions options{.episodes = 2, .workers = 2, .seed = 1};
  std::vector<double> shares;
  const Transfer transfer = transfer_policy(config, "random", available_engines(), {"flat", config.terrain},
                                            options, watched(shares));
  expect_to_the_end(shares);
  ASSERT_EQ(transfer.cells.size(), 2 * available_engines().size());
  EXPECT_EQ(transfer.cells[0].terrain, "flat");
  for (const TransferCell& cell : transfer.cells) {
    if (cell.engine != GetParam() || cell.terrain == "flat") continue;
    const Rollout rollout = roll_out(config, {"random", "zero"}, options);
    EXPECT_EQ(to_json(cell.policy), to_json(rollout.policies[0].all));
    EXPECT_EQ(to_json(cell.baseline), to_json(rollout.policies[1].all));
  }
}

TEST_P(Studies, TuningDoesNotHangOnThreadsAndEndsNoWorseThanItBegan) {
  EnvConfig config = short_episodes(GetParam());
  config.adapt = {"step_length", "cycle_time"};
  TuneOptions options{.iterations = 2, .population = 4, .terrains = 1, .unseen = 1, .workers = 1, .seed = 1};
  std::vector<double> shares;
  const Tuning one = tune_gait(config, {GetParam()}, options, watched(shares));
  expect_to_the_end(shares);
  options.workers = 3;
  EXPECT_EQ(to_json(tune_gait(config, {GetParam()}, options)).dump(), to_json(one).dump());
  ASSERT_EQ(one.history.size(), 2U);
  EXPECT_GE(one.history[1], one.history[0]);
  EXPECT_EQ(one.score, one.history.back());
  ASSERT_EQ(one.checks.size(), 4U);  // default and tuned, on the seed tuned on and on another
  EXPECT_GE(one.checks[1].per_engine[0].mean_speed(), one.checks[0].per_engine[0].mean_speed());
}

TEST(Evaluations, AreToldInWords) {
  Evaluation e;
  EXPECT_EQ(outcomes_in_words(e), "all walked");
  e.outcomes[static_cast<std::size_t>(Outcome::kLeftTerrain)] = 1;
  e.outcomes[static_cast<std::size_t>(Outcome::kFell)] = 3;
  e.outcomes[static_cast<std::size_t>(Outcome::kWalked)] = 2;
  EXPECT_EQ(outcomes_in_words(e), "3 fell, 1 left the terrain");
}

}  // namespace
}  // namespace crossgait
