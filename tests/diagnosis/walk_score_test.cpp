#include "diagnosis/walk_score.h"

#include <gtest/gtest.h>

#include "policy/bundled_policies.h"

namespace crossgait {
namespace {

WalkMeasure walk(const VelocityCommand& asked) {
  WalkMeasure measure;
  measure.asked = asked;
  return measure;
}

TEST(WalkScore, IsNothingForWhatWasAskedWithoutEffort) {
  EXPECT_EQ(walk_score(walk({0.5, 0, 0.4})), 0);
  EXPECT_EQ(walk_score(walk({0, 0, 0})), 0);
}

TEST(WalkScore, AddsUpItsTermsAndCapsEach) {
  WalkMeasure measure = walk({0.5, 0, 0.4});
  measure.speed_error = 0.25;    // half of the command
  measure.yaw_rate_error = 0.1;  // a quarter of it
  EXPECT_DOUBLE_EQ(walk_score(measure), 0.75);
  measure.jitter = 250;
  measure.effort = 1.5;
  measure.tilt = 0.1;  // half of each, weighted 0.3, 0.2, 0.3
  EXPECT_DOUBLE_EQ(walk_score(measure), 0.75 + 0.4);
  measure.speed_error = measure.yaw_rate_error = measure.jitter = measure.effort = measure.tilt = 1e9;
  EXPECT_DOUBLE_EQ(walk_score(measure), 2.8);
}

TEST(WalkScore, PutsEveryFallBehindEveryWalkAndLaterFallsBeforeEarlierOnes) {
  WalkMeasure measure = walk({0.5, 0, 0});
  measure.fell = true;
  measure.lasted = measure.upright = 0.25;
  EXPECT_DOUBLE_EQ(walk_score(measure), 3.75);
  measure.upright = 0.05;  // it leaned long before it fell
  EXPECT_DOUBLE_EQ(walk_score(measure), 3.85);
  measure.lasted = measure.upright = 1;
  EXPECT_GT(walk_score(measure), 2.8);
}

TEST(WalkScore, HoldsStandingAgainstTheReferenceSpeed) {
  WalkMeasure measure = walk({0, 0, 0});
  measure.speed_error = 0.15;  // half of 0.3 m/s
  EXPECT_DOUBLE_EQ(walk_score(measure), 0.5);
}

WalkResult result_of(const std::vector<WalkMeasure>& walks) {
  WalkResult result;
  for (const WalkMeasure& one : walks) {
    result.walks.push_back(one);
    result.scores.push_back(walk_score(one));
  }
  return result;
}

TEST(WalkResult, MeansOverCommandsAndSeeds) {
  WalkResult result;
  result.scores = {1, 2, 3, 5};  // two commands of two seeds
  EXPECT_DOUBLE_EQ(result.mean(), 2.75);
  EXPECT_EQ(result.by_seed(2), (std::vector{2.0, 3.5}));
}

TEST(WalkResult, DoesWhatIsAskedUpToTheTolerance) {
  const WalkTest test{{{"straight ahead", {0.5, 0, 0}}}, 2, 3, 0};
  WalkMeasure a = walk({0.5, 0, 0}), b = a;
  a.speed_error = 0.2;
  b.speed_error = 0.09;  // a mean of 0.145, within 0.2 of 0.5 and 0.05
  EXPECT_TRUE(does_what_is_asked(result_of({a, b}), 2));
  EXPECT_EQ(what_is_wrong(result_of({a, b}), test), "does what it is asked");
  b.speed_error = 0.11;  // 0.155
  EXPECT_FALSE(does_what_is_asked(result_of({a, b}), 2));
  EXPECT_EQ(what_is_wrong(result_of({a, b}), test), "misses the speed by 0.15 m/s straight ahead");
  b = a = walk({0.5, 0, 0});
  a.yaw_rate_error = b.yaw_rate_error = 0.13;  // 0.12 where none is asked for
  EXPECT_FALSE(does_what_is_asked(result_of({a, b}), 2));
  EXPECT_EQ(what_is_wrong(result_of({a, b}), test), "misses the yaw rate by 0.13 rad/s straight ahead");
  a = b = walk({0.5, 0, 0});
  b.fell = true;
  EXPECT_FALSE(does_what_is_asked(result_of({a, b}), 2));
  EXPECT_EQ(what_is_wrong(result_of({a, b}), test), "falls in 1 of 2 walks");
}

TEST(WalkCommands, AreAboutWhatTheEnvironmentAsksFor) {
  EnvConfig config = joint_environment();
  config.command = VelocityCommand{0.7, 0.1, 0.2};
  const std::vector<WalkCommand> commands = walk_commands(config);
  ASSERT_EQ(commands.size(), 4U);
  EXPECT_EQ(commands[0].velocity.vx, 0.7);
  EXPECT_EQ(commands[0].velocity.vy, 0);
  EXPECT_EQ(commands[0].velocity.yaw_rate, 0);
  EXPECT_EQ(commands[1].velocity.yaw_rate, -commands[2].velocity.yaw_rate);
  EXPECT_EQ(commands[3].velocity.vx, 0);
  config.command = VelocityCommand{0, 0, 0};  // a policy that is asked to stand is to walk as well
  EXPECT_GT(walk_commands(config)[0].velocity.vx, 0);
}

TEST(RunWalks, AreTheSameAgainAndOthersOfOtherSeeds) {
  const LoadedEnv environment(load_env_config(*environment_of_policy("serial_joints")));
  const RelabelledPolicy policy = read_relabelled_policy("serial_joints");
  const WalkTest test{{{"straight ahead", {0.7, 0, 0}}}, 2, 1.5, 0};
  const WalkResult a = run_walks(environment, policy, test, 3);
  EXPECT_EQ(run_walks(environment, policy, test, 3).scores, a.scores);
  ASSERT_EQ(a.scores.size(), 2U);
  EXPECT_NE(a.scores[0], a.scores[1]);
  WalkTest second = test;  // the second seed alone
  second.seeds = 1;
  second.first = 1;
  EXPECT_EQ(run_walks(environment, policy, second, 3).scores, (std::vector{a.scores[1]}));
}

}  // namespace
}  // namespace crossgait
