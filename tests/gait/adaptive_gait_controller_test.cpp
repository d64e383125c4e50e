#include "gait/adaptive_gait_controller.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "physics/core/error.h"
#include "tests/gait/test_robot.h"
#include "tests/support/constants.h"

namespace crossgait {
namespace {

using test::kDt;
using test::kNaN;

// The guide's round numbers.
AdaptiveGaitOptions guide_options() {
  AdaptiveGaitOptions options;
  options.ranges = guide_ranges();
  options.initial = guide_adaptive_parameters();
  return options;
}

AdaptiveGaitController adaptive(const AdaptiveGaitOptions& options = guide_options()) {
  return {find_gait("trot:guide"), options, test::leg_origins()};
}

std::vector<double> zeros(const AdaptiveGaitController& c) {
  return std::vector<double>(c.action_size(), 0.0);
}

TEST(AdaptiveGait, HasTheGuidesActionSizes) {
  AdaptiveGaitOptions options = guide_options();
  EXPECT_EQ(adaptive(options).action_size(), 16u);
  options.parameters.emplace_back("stance_width");
  EXPECT_EQ(adaptive(options).action_size(), 17u);
  options.parameters.emplace_back("foot_clearance");
  EXPECT_EQ(adaptive(options).action_size(), 18u);
  EXPECT_EQ(adaptive(options).adapted()[5].name, "foot_clearance");
}

TEST(AdaptiveGait, ZeroActionsAreThePlainGait) {
  AdaptiveGaitController c = adaptive();
  GaitGenerator plain(find_gait("trot:guide"), guide_adaptive_parameters(), test::leg_origins());
  const std::vector<double> action = zeros(c);
  for (int i = 0; i < 1000; ++i) {
    c.apply_action(action);
    c.update(kDt);
    plain.update(kDt);
    EXPECT_EQ(c.phase(), plain.phase());
    for (const Leg leg : kLegs) {
      ASSERT_EQ(c.targets()[leg].position, plain.targets()[leg].position);
      ASSERT_EQ(c.is_swing(leg), plain.targets()[leg].swing);
    }
  }
}

TEST(AdaptiveGait, DeltasAddUpAndStopAtTheRange) {
  AdaptiveGaitController c = adaptive();
  const std::vector<double> deltas{0.01, -0.005, 0.1, 0.002};
  c.add_deltas(deltas);
  EXPECT_EQ(c.parameters().step_height, 0.04 + 0.01);
  EXPECT_EQ(c.parameters().step_length, 0.06 - 0.005);
  EXPECT_EQ(c.parameters().cycle_time, 0.8 + 0.1);
  EXPECT_EQ(c.parameters().body_height, 0.05 + 0.002);
  for (int i = 0; i < 100; ++i) c.add_deltas(deltas);
  EXPECT_EQ(c.parameters().step_height, 0.09);
  EXPECT_EQ(c.parameters().step_length, 0.03);
  EXPECT_EQ(c.parameters().cycle_time, 1.5);
  EXPECT_EQ(c.parameters().body_height, 0.055);
  EXPECT_EQ(c.parameters().stance_width, 0.08);  // not adapted
}

TEST(AdaptiveGait, ActionsAreScaledByTheTable) {
  AdaptiveGaitController c = adaptive();
  std::vector<double> action = zeros(c);
  action[0] = 1;    // step_height
  action[2] = 0.5;  // cycle_time
  action[3] = -7;   // body_height, clipped to -1
  action[4] = 1;    // FL x
  action[15] = -3;  // RR z, clipped to -1
  c.apply_action(action);
  EXPECT_EQ(c.parameters().step_height, 0.04 + 0.005);
  EXPECT_EQ(c.parameters().cycle_time, 0.8 + 0.5 * 0.05);
  EXPECT_EQ(c.parameters().body_height, 0.05 - 0.003);
  EXPECT_EQ(c.residuals()[Leg::FL], Vector3(0.01, 0, 0));
  EXPECT_EQ(c.residuals()[Leg::RR], Vector3(0, 0, -0.01));
}

TEST(AdaptiveGait, ResidualsAreClippedAndActAtOnce) {
  AdaptiveGaitController c = adaptive(), plain = adaptive();
  LegArray<Vector3> residuals;
  residuals.fill({0.004, -1, kNaN});
  c.set_residuals(residuals);
  c.update(kDt);
  plain.update(kDt);
  for (const Leg leg : kLegs) {
    EXPECT_EQ(c.targets()[leg].position, plain.targets()[leg].position + Vector3(0.004, -0.01, 0));
  }
}

TEST(AdaptiveGait, APositiveZResidualRaisesTheFoot) {
  AdaptiveGaitController c = adaptive(), plain = adaptive();
  std::vector<double> action = zeros(c);
  action[6] = 0.5;  // FL z
  c.apply_action(action);
  c.update(kDt);
  plain.update(kDt);
  const double stand = plain.targets()[Leg::RR].position.z(), z = plain.targets()[Leg::FL].position.z();
  EXPECT_LT(stand, 0);  // below the shoulders, and up is towards them
  EXPECT_EQ(c.targets()[Leg::FL].position.z(), z + 0.005);
  EXPECT_EQ(c.targets()[Leg::RR].position.z(), stand);
}

TEST(AdaptiveGait, NormalisesParametersInTheOrderOfTheNames) {
  AdaptiveGaitOptions options = guide_options();
  options.parameters = {"cycle_time", "step_height"};
  options.initial.cycle_time = 1.5;
  options.initial.step_height = 0.06;
  const AdaptiveGaitController c = adaptive(options);
  std::vector<double> out(2);
  c.normalised_parameters(out);
  EXPECT_EQ(out[0], 1);
  EXPECT_NEAR(out[1], 0, 1e-15);  // the middle of 0.03 to 0.09, but for rounding
}

TEST(AdaptiveGait, NonsenseActionsCountAsZero) {
  AdaptiveGaitController c = adaptive();
  std::vector<double> action(c.action_size(), kNaN);
  action[5] = std::numeric_limits<double>::infinity();
  c.apply_action(action);
  c.add_deltas(std::vector<double>(4, kNaN));
  EXPECT_EQ(c.parameters().step_height, 0.04);
  for (const Vector3& residual : c.residuals()) EXPECT_EQ(residual, Vector3(0, 0, 0));
  c.apply_action({});                            // too short: the rest is zero
  c.add_deltas(std::vector<double>(40, 0.001));  // too long: the rest is ignored
  EXPECT_EQ(c.parameters().step_height, 0.041);
  for (const FootTarget& foot : c.update(kDt)) EXPECT_TRUE(foot.position.allFinite());
}

TEST(AdaptiveGait, CycleTimeKeepsThePhase) {
  AdaptiveGaitController c = adaptive();
  for (int i = 0; i < 137; ++i) c.update(kDt);
  const double phase = c.phase();
  const LegArray<FootTarget> before = c.targets();
  c.add_deltas(std::vector<double>{0, 0, 0.7, 0});
  EXPECT_EQ(c.phase(), phase);
  c.update(1e-9);
  for (const Leg leg : kLegs) {
    EXPECT_LT((c.targets()[leg].position - before[leg].position).norm(),
              1e-9);  // below 1 m/s for a nanosecond
  }
}

TEST(AdaptiveGait, ResetForgets) {
  AdaptiveGaitController c = adaptive(), fresh = adaptive();
  c.apply_action(std::vector<double>(c.action_size(), 1.0));
  for (int i = 0; i < 100; ++i) c.update(kDt);
  c.reset();
  EXPECT_EQ(c.parameters().step_height, 0.04);
  for (int i = 0; i < 100; ++i) {
    c.update(kDt);
    fresh.update(kDt);
    for (const Leg leg : kLegs) ASSERT_EQ(c.targets()[leg].position, fresh.targets()[leg].position);
  }
}

TEST(AdaptiveGait, WrongNamesAreErrorsWhenConfigured) {
  AdaptiveGaitOptions options = guide_options();
  options.parameters = {"step_height", "stance_widht"};
  try {
    adaptive(options);
    FAIL() << "no error";
  } catch (const ConfigError& e) {
    EXPECT_NE(e.found().find("stance_widht"), std::string::npos);
    EXPECT_NE(e.expected().find("stance_width"), std::string::npos);
  }
  options.parameters = {"step_height", "step_height"};
  EXPECT_THROW(adaptive(options), ConfigError);
}

TEST(AdaptiveGait, WhatBeginsOutsideItsRangeOnlyComesNearer) {
  AdaptiveGaitOptions options = guide_options();
  options.initial.cycle_time = 0.5;    // of 0.8 to 1.5 s
  options.initial.body_height = 0.07;  // of 0.04 to 0.055 m
  AdaptiveGaitController c = adaptive(options);
  std::vector<double> action = zeros(c);
  c.apply_action(action);
  EXPECT_EQ(c.parameters().cycle_time, 0.5);
  EXPECT_EQ(c.parameters().body_height, 0.07);
  action[2] = -1;
  action[3] = 1;
  c.apply_action(action);
  EXPECT_EQ(c.parameters().cycle_time, 0.5);
  EXPECT_EQ(c.parameters().body_height, 0.07);
  std::vector<double> normalised(4);
  c.normalised_parameters(normalised);
  EXPECT_NEAR(normalised[2], 2 * (0.5 - 0.8) / 0.7 - 1, 1e-15);  // beyond -1, by the same scale; rounding
  action[2] = 1;
  action[3] = -1;
  c.apply_action(action);
  EXPECT_EQ(c.parameters().cycle_time, 0.5 + 0.05);
  EXPECT_EQ(c.parameters().body_height, 0.07 - 0.003);
  for (int i = 0; i < 10; ++i) c.apply_action(action);
  action[2] = -1;
  for (int i = 0; i < 100; ++i) c.apply_action(action);
  EXPECT_EQ(c.parameters().cycle_time, 0.8) << "once inside, it stays";
}

TEST(AdaptiveGait, TakesOtherRangesAndScales) {
  AdaptiveGaitOptions options = guide_options();
  options.ranges.ranges["cycle_time"] = {0.15, 0.8};
  options.ranges.delta_scales["cycle_time"] = 0.02;
  options.initial.cycle_time = 0.5;
  AdaptiveGaitController c = adaptive(options);
  std::vector<double> action = zeros(c), normalised(4);
  action[2] = -1;
  c.apply_action(action);
  EXPECT_EQ(c.parameters().cycle_time, 0.48);
  for (int i = 0; i < 100; ++i) c.apply_action(action);
  EXPECT_EQ(c.parameters().cycle_time, 0.15);
  c.normalised_parameters(normalised);
  EXPECT_EQ(normalised[2], -1);
  const AdaptiveGaitController copy = c;  // rows are the controller's own
  EXPECT_EQ(copy.adapted()[2].max, 0.8);
  EXPECT_EQ(copy.adapted()[0].max, 0.09);  // the guide's
}

TEST(AdaptiveGait, RefusesBadOptions) {
  AdaptiveGaitOptions options = guide_options();
  options.initial.cycle_time = 0;
  EXPECT_THROW(adaptive(options), ConfigError);
  options.initial = {};
  options.ranges.ranges["cycle_time"] = {1, 0.5};
  EXPECT_THROW(adaptive(options), ConfigError);
  options.ranges = {};
  for (const double bad : {-0.01, kNaN}) {
    options.residual_scale = bad;
    EXPECT_THROW(adaptive(options), ConfigError);
  }
}

}  // namespace
}  // namespace crossgait
