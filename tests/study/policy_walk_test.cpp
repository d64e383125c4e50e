// A policy's episode in several engines: the same as a rollout's, and compared step by step.
#include "study/policy_walk.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "backends/registry.h"
#include "policy/bundled_policies.h"
#include "tests/physics/core/config_error.h"

namespace crossgait {
namespace {

constexpr const char* kPolicy = "serial_joints";  // comes with Crossgait

LoadedEnv short_environment() {
  EnvConfig config = load_env_config(environment_file("", kPolicy));
  config.episode_seconds = 0.4;
  return LoadedEnv(config);
}

TEST(PolicyWalk, IsTheFirstEpisodeOfARollout) {
  LoadedEnv environment = short_environment();
  for (const std::string& engine : available_engines()) {
    environment.config.engine = engine;
    TraceRecorder trace;
    const Comparison one = compare_episodes(environment, kPolicy, {engine}, 3, {}, {}, {&trace});
    ASSERT_EQ(one.runs.size(), 1U);
    EXPECT_TRUE(one.pairs.empty());
    EXPECT_EQ(one.runs[0].engine.name, engine);
    EXPECT_EQ(trace.samples().size(), 20U);  // policy steps of 20 ms
    const Rollout rollout = roll_out(environment, std::vector<std::string>{kPolicy}, {1, 1, 3});
    EXPECT_EQ(one.runs[0].summary.distance_m, rollout.policies[0].episodes[0].motion.distance_m) << engine;
  }
}

TEST(PolicyWalk, EnginesOfTheSameLawsStayTogether) {
  const std::vector<std::string> available = available_engines();
  const std::vector<std::string> engines{"mujoco", "bullet:matched"};
  for (const std::string& engine : engines) {
    if (std::find(available.begin(), available.end(), engine) == available.end())
      GTEST_SKIP() << engine << " is not there";
  }
  const Comparison both = compare_episodes(short_environment(), kPolicy, engines, 0);
  ASSERT_EQ(both.pairs.size(), 1U);
  EXPECT_TRUE(both.pairs[0].same_laws);
  EXPECT_FALSE(both.pairs[0].first_divergence);
  EXPECT_GT(both.pairs[0].max_joint_difference_rad, 0);  // two codes, not one run twice
}

TEST(PolicyWalk, TakesEachEngineOnce) {
  EXPECT_NE(std::string(
                config_error([] {
                  static_cast<void>(compare_episodes(short_environment(), kPolicy, {"mujoco", "mujoco"}, 0));
                }).what())
                .find("engines: expected each engine once"),
            std::string::npos);
}

}  // namespace
}  // namespace crossgait
