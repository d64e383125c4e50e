// The same environment, seed and actions give the same observations bit for bit: 10,000 policy steps.
#include "env/vector_env.h"
#include "tests/support/engine_test.h"
#include "tests/support/environments.h"

namespace crossgait {
namespace {

constexpr int kPolicySteps = 10'000;

EnvConfig rough_ground() {
  EnvConfig config;
  config.terrain = "rough";
  config.episode_seconds = 30;
  config.observation.emplace_back("terrain");
  return config;
}

// Joints commanded, with everything that an observer and a delay remember.
EnvConfig joints_on_rough_ground() {
  EnvConfig config = joint_environment();
  config.terrain = "rough";
  config.policy_dt = 4e-3;
  config.episode_seconds = 5;  // so that some end
  config.joints.scale.all = 0.05;
  config.joints.delay = 6e-3;
  config.observation[4].delay = 2e-3;
  config.observation[4].history = 3;
  config.observation[3].noise = 0.01;
  return config;
}

class EnvironmentDeterminism : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(EnvironmentDeterminism);

void expect_the_same_again(const EnvConfig& config, const Engine& engine, int steps) {
  QuadrupedEnv env(config, engine), other(config, engine);
  std::vector<double> seen(env.observation_size());
  const auto begin = [&](QuadrupedEnv& e) {
    e.reset(5, seen);
    return Random(6);
  };
  Random random = begin(env);
  std::vector<double> first = scenes::record(env, random, steps / 2);
  const auto saved = env.save();
  const Random at_save = random;
  const std::vector<double> second = scenes::record(env, random, steps / 2);

  env.restore(*saved);
  random = at_save;
  EXPECT_EQ(scenes::record(env, random, steps / 2), second);
  first.insert(first.end(), second.begin(), second.end());
  random = begin(env);
  EXPECT_EQ(scenes::record(env, random, steps), first);
  random = begin(other);
  EXPECT_EQ(scenes::record(other, random, steps), first);
}

TEST_P(EnvironmentDeterminism, AfterResetRestoreAndInAnotherInstance) {
  expect_the_same_again(rough_ground(), find_engine(GetParam()), kPolicySteps);
}

TEST_P(EnvironmentDeterminism, OfJointActionsToo) {
  constexpr int kSteps = 3000;  // what differs from a gait is the action: its delay is done with in two steps
  expect_the_same_again(joints_on_rough_ground(), find_engine(GetParam()), kSteps);
}

TEST_P(EnvironmentDeterminism, WithOneAndTwoWorkers) {
  EnvConfig config = rough_ground();
  config.episode_seconds = 1;  // with resets in between
  config.randomisation[Randomised::kStartYaw] = {-1, 1};
  VectorEnv one(config, find_engine(GetParam()), {.environments = 4, .workers = 1}),
      two(config, find_engine(GetParam()), {.environments = 4, .workers = 2});
  const std::size_t rows = one.size();
  std::vector<double> a(rows * one.observation_size()), b(a.size()), reward_a(rows), reward_b(rows);
  std::vector<std::uint8_t> terminated_a(rows), terminated_b(rows), truncated_a(rows), truncated_b(rows);
  one.reset(1, a);
  two.reset(1, b);
  Random random(2);
  for (int i = 0; i < kPolicySteps / static_cast<int>(rows); ++i) {
    const std::vector<double> action = scenes::random_action(random, rows * one.action_size());
    one.step(action, {a, reward_a, terminated_a, truncated_a});
    two.step(action, {b, reward_b, terminated_b, truncated_b});
    ASSERT_EQ(a, b);
    ASSERT_EQ(reward_a, reward_b);
    ASSERT_EQ(terminated_a, terminated_b);
    ASSERT_EQ(truncated_a, truncated_b);
  }
  EXPECT_GT(one.episodes(), 8U);
}

}  // namespace
}  // namespace crossgait
