#include "policy/scripted_policy.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "gait/adaptive_gait_controller.h"
#include "physics/core/yaml_reader.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/kept_inputs.h"
#include "tests/policy/policy_interfaces.h"

namespace crossgait {
namespace {

using policy_tests::small_interface;

std::unique_ptr<Policy> parse(const std::string& steps,
                              const PolicyInterface& interface = small_interface()) {
  const std::string text = "kind: scripted\nsteps: " + steps;
  keep_input("policy.yaml", text);
  return load_scripted_policy(YamlValue::parse(text, "folder/script.yaml"))(interface);
}

std::vector<double> act_at(Policy& policy, double step_height = 0) {
  const std::vector<double> observation{0, step_height, 0, 0};
  std::vector<double> action(4, 9);
  policy.act(observation, action);
  return action;
}

TEST(ScriptedPolicy, HoldsEachStepUntilTheNext) {
  const auto policy = parse(
      "[{time: .004, action: {delta.step_length: 1, residual.FL.z: -.2}}, {time: .008, action: "
      "{residual.FL.x: .5}},"
      " {time: .012}]");
  EXPECT_EQ(policy->name(), "script.yaml");
  for (const std::uint64_t seed : {1, 2}) {
    policy->reset(seed);
    for (int i = 0; i < 2; ++i) EXPECT_EQ(act_at(*policy), (std::vector<double>{0, 0, 0, 0}));
    for (int i = 0; i < 2; ++i) EXPECT_EQ(act_at(*policy), (std::vector<double>{0, 1, 0, -0.2}));
    for (int i = 0; i < 2; ++i) EXPECT_EQ(act_at(*policy), (std::vector<double>{0, 0, 0.5, 0}));
    for (int i = 0; i < 2; ++i) EXPECT_EQ(act_at(*policy), (std::vector<double>{0, 0, 0, 0}));
  }
}

TEST(ScriptedPolicy, TimesThatAreNoBinaryFractionsBeginInTheirStep) {
  // 0.3 / 0.1 is 2.9999999999999996 and 0.7 / 0.1 is 6.999999999999999; 1.15 lies between two steps.
  PolicyInterface interface = small_interface();
  interface.policy_dt = 0.1;
  const auto policy = parse(
      "[{time: .3, action: {residual.FL.x: .3}}, {time: .7, action: {residual.FL.x: .7}},"
      " {time: 1.15, action: {residual.FL.x: 1}}]",
      interface);
  const std::vector<double> expected{0, 0, 0, 0.3, 0.3, 0.3, 0.3, 0.7, 0.7, 0.7, 0.7, 0.7, 1, 1};
  for (const double value : expected) EXPECT_EQ(act_at(*policy)[2], value);
}

TEST(ScriptedPolicy, SteersAParameterToItsTarget) {
  // step_height from 0.04 to 0.052: 3 steps of 0.004; to 0.0435 afterwards: 2 steps, and the rest of 0.0005.
  const auto policy =
      parse("[{time: 0, parameters: {step_height: .052}}, {time: .012, parameters: {step_height: .0435}}]");
  AdaptiveGaitOptions options;
  options.parameters = {"step_height", "step_length"};
  AdaptiveGaitController gait(find_gait("trot"), options, {});
  const std::vector<double> expected{0.044, 0.048, 0.052,  0.052,  0.052, 0.052,
                                     0.048, 0.044, 0.0435, 0.0435, 0.0435};
  for (const double height : expected) {
    std::vector<double> normalised(2);
    gait.normalised_parameters(normalised);
    gait.apply_action(act_at(*policy, normalised[0]));
    EXPECT_NEAR(gait.parameters().step_height, height, 1e-15);  // rounding of the normalisation
    EXPECT_EQ(gait.parameters().step_length, GaitParameters{}.step_length);
  }
}

TEST(ScriptedPolicy, SteersInTheEnvironmentsRanges) {
  PolicyInterface interface = small_interface();
  interface.adaptation.ranges["step_height"] = {0.01, 0.2};
  interface.adaptation.delta_scales["step_height"] = 0.02;
  const auto policy = parse("[{time: 0, parameters: {step_height: .15}}]", interface);
  AdaptiveGaitOptions options;
  options.parameters = {"step_height", "step_length"};
  options.ranges = interface.adaptation;
  AdaptiveGaitController gait(find_gait("trot"), options, {});
  for (int i = 0; i < 6; ++i) {  // 0.11 m in steps of 0.02
    std::vector<double> normalised(2);
    gait.normalised_parameters(normalised);
    gait.apply_action(act_at(*policy, normalised[0]));
  }
  EXPECT_NEAR(gait.parameters().step_height, 0.15, 1e-15);  // rounding of the normalisation
}

TEST(ScriptedPolicy, AnObservationThatIsNoNumberSteersNowhere) {
  const auto policy = parse("[{time: 0, action: {residual.FL.x: .5}, parameters: {step_height: .052}}]");
  EXPECT_EQ(act_at(*policy, std::nan("")), (std::vector<double>{0, 0, 0.5, 0}));
}

struct BadScript {
  const char* name;
  const char* steps;
  const char* message;
};

void PrintTo(const BadScript& bad, std::ostream* stream) { *stream << bad.name; }

class BadScripts : public ::testing::TestWithParam<BadScript> {};

TEST_P(BadScripts, AreRefused) {
  EXPECT_EQ(std::string(config_error([] { (void)parse(GetParam().steps); }).what()),
            std::string("folder/script.yaml: ") + GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    ScriptedPolicy, BadScripts,
    ::testing::Values(
        BadScript{"None", "[]", "line 2, steps: expected at least one step, found none"},
        BadScript{
            "UnknownKey", "[{time: 0, actions: {}}]",
            "line 2, steps[0].actions: expected one of the keys time, action, parameters, found unknown key "
            "'actions' (did you mean action?)"},
        BadScript{"NoTime", "[{action: {}}]", "line 2, steps[0]: expected key 'time', found none"},
        BadScript{"NegativeTime", "[{time: -1}]",
                  "line 2, steps[0].time: expected a time of 0 s or more, found -1"},
        BadScript{"EndlessTime", "[{time: 1e300}]",
                  "line 2, steps[0].time: expected a time of 0 s or more, found 1e+300"},
        BadScript{"TimesTooClose", "[{time: 1}, {time: 1.0}]",
                  "line 2, steps[1].time: expected at least one policy step (0.002 s) after the step before, "
                  "found 1"},
        BadScript{
            "UnknownEntry", "[{time: 0, action: {residual.FL.y: 0}}]",
            "line 2, steps[0].action.residual.FL.y: expected one of delta.step_height, delta.step_length, "
            "residual.FL.x, residual.FL.z, found an unknown action entry"},
        BadScript{"LargeAction", "[{time: 0, action: {residual.FL.x: 1.5}}]",
                  "line 2, steps[0].action.residual.FL.x: expected -1 to 1, found 1.5"},
        BadScript{
            "UnknownParameter", "[{time: 0, parameters: {cycle_time: 1}}]",
            "line 2, steps[0].parameters.cycle_time: expected one of the parameters that adapt: step_height, "
            "step_length, found another name"},
        BadScript{"ParameterNotObserved", "[{time: 0, parameters: {step_length: .05}}]",
                  "line 2, steps[0].parameters.step_length: expected an observation with param.step_length, "
                  "found one "
                  "without"},
        BadScript{"TargetOutOfRange", "[{time: 0, parameters: {step_height: .1}}]",
                  "line 2, steps[0].parameters.step_height: expected 0.015 to 0.055 m, found 0.1"},
        BadScript{
            "EntryTwice", "[{time: 0, action: {delta.step_height: 0}, parameters: {step_height: .05}}]",
            "line 2, steps[0].parameters.step_height: expected each action entry once, found a second one in "
            "the same step"}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace crossgait
