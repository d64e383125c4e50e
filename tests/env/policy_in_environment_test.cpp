// Policies of every kind in the environment that they are for.
#include <cmath>

#include <gtest/gtest.h>

#include "policy/hierarchical_policy.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/policy/policy_interfaces.h"
#include "tests/support/engine_test.h"
#include "tests/support/environments.h"

namespace crossgait {
namespace {

using policy_tests::random_network;

class PolicyInEnvironment : public ScratchFolder {
 protected:
  /// Step heights after each policy step of one second.
  static std::vector<double> step_heights(QuadrupedEnv& env, Policy& policy) {
    std::vector<double> observation(env.observation_size()), action(env.action_size()), heights;
    env.reset(1, observation);
    policy.reset(1);
    for (int i = 0; i < 500; ++i) {
      policy.act(observation, action);
      EXPECT_FALSE(env.step(action, observation).terminated);
      heights.push_back(env.info().parameters->step_height);
    }
    return heights;
  }

  QuadrupedEnv env_{EnvConfig{}, find_engine(available_engines().front())};
};

TEST_F(PolicyInEnvironment, AScriptSteersParameters) {
  const auto policy =
      make_policy(write("s.yaml",
                        "{kind: scripted, layout_version: 3,"
                        " steps: [{time: 0.2, parameters: {step_height: 0.05}}, {time: 0.6}]}"),
                  env_.interface());
  const std::vector<double> heights = step_heights(env_, *policy);
  const double start = heights[0], scale = find_parameter("step_height").delta_scale;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const double expected = i < 100 ? start : std::min(0.05, start + static_cast<double>(i - 99) * scale);
    EXPECT_NEAR(heights[i], expected, 1e-12) << i;  // rounding of normalised parameters
  }
}

TEST_F(PolicyInEnvironment, APlannerChangesParametersWhenItPlans) {
  const PolicyInterface planner =
      member_interface(env_.interface(), {"p_WB.", "param."}, "delta.", 0.1, "test");
  write_policy_bundle(path("planner.safetensors"), random_network(planner, {16}), planner);
  const PolicyInterface residual = member_interface(env_.interface(), {}, "residual.", 2e-3, "test");
  write_policy_bundle(path("residual.safetensors"), random_network(residual, {32, 16}), residual);
  const auto policy =
      make_policy(write("h.yaml",
                        "kind: hierarchical\n"
                        "layout_version: 3\n"
                        "planner: {policy: planner.safetensors, observation: [p_WB., param.]}\n"
                        "residual: {policy: residual.safetensors}\n"),
                  env_.interface());
  const std::vector<double> heights = step_heights(env_, *policy);
  EXPECT_NE(heights[0], find_gait("trot").preferred.step_height);
  for (std::size_t i = 1; i < heights.size(); ++i) {
    EXPECT_TRUE(i % 50 == 0 || heights[i] == heights[i - 1]) << i;
  }
  EXPECT_NE(heights[50], heights[49]);
}

}  // namespace
}  // namespace crossgait
