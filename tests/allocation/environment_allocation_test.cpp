// No allocation per policy step, in one environment or many.
#include <gtest/gtest.h>

#include "crossgait/env/vector_env.h"
#include "crossgait/tests/support/allocation_counter.h"
#include "crossgait/tests/support/backend_test.h"
#include "crossgait/tests/support/environments.h"

namespace crossgait {
namespace {

class EnvironmentAllocation : public BackendTest {};
CROSSGAIT_FOR_EVERY_BACKEND(EnvironmentAllocation);

EnvConfig everything() {
  EnvConfig config;
  config.terrain = "rough";
  config.observation.clear();
  for (const ObservationBlock& block : observation_blocks()) config.observation.emplace_back(block.name);
  config.reward.fill(1);
  return config;
}

TEST_P(EnvironmentAllocation, NonePerStep) {
  AdaptiveGaitEnv env(everything(), find_engine(GetParam()));
  std::vector<double> seen(env.observation_size());
  env.reset(1, seen);
  Random random(2);
  std::vector<double> action(env.action_size());
  const auto steps = [&](int count) {
    for (int i = 0; i < count; ++i) {
      for (double& a : action) a = random.uniform(-0.5, 0.5);
      env.step(action, seen);
    }
  };
  steps(1000);  // every buffer has had its largest size
  const AllocationScope scope;
  steps(1000);
  EXPECT_EQ(scope.count(), 0U);
}

TEST_P(EnvironmentAllocation, NonePerStepOfABatch) {
  VectorEnv env(everything(), find_engine(GetParam()), {.environments = 3, .workers = 2});
  std::vector<double> seen(3 * env.observation_size()), rewards(3), actions(3 * env.action_size(), 0.1);
  std::vector<std::uint8_t> terminated(3), truncated(3);
  env.reset(1, seen);
  const auto steps = [&](int count) {
    for (int i = 0; i < count; ++i) env.step(actions, {seen, rewards, terminated, truncated});
  };
  steps(1000);
  const AllocationScope scope;
  steps(500);
  EXPECT_EQ(scope.count(), 0U);
}

}  // namespace
}  // namespace crossgait
