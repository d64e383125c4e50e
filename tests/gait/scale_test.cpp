#include "gait/scale.h"

#include <gtest/gtest.h>

namespace crossgait {
namespace {

constexpr GaitScale kTwice{.length = 4};  // four times as high: times and speeds double

TEST(GaitScale, IsOneForTheReferenceAndForRobotsOfNoSize) {
  RobotDescription robot;
  EXPECT_EQ(gait_scale(robot).length, 1);
  robot.standing_height = kReferenceHeight;
  EXPECT_EQ(gait_scale(robot).length, 1);
  robot.standing_height = 0.288;
  robot.stance_offset = -0.01;
  EXPECT_DOUBLE_EQ(gait_scale(robot).length, 0.288 / 0.062);
  EXPECT_EQ(gait_scale(robot).stance_offset, -0.01);
}

TEST(GaitScale, ScalesLengthsAndTimesAndNothingElse) {
  const GaitParameters p = find_gait("trot").preferred, twice = scaled(p, kTwice);
  for (const ParameterRow& row : gait_parameters()) {
    const double factor = row.unit == "m" ? 4 : row.unit == "s" ? 2 : 1;
    EXPECT_EQ(twice.*row.member, factor * (p.*row.member)) << row.name;
    EXPECT_EQ(scaled(p, {}).*row.member, p.*row.member) << row.name;
  }
  const StepLimits limits = scaled(StepLimits{0.1, 0.05}, kTwice);
  EXPECT_EQ(limits.max_x, 0.4);
  EXPECT_EQ(limits.max_y, 0.2);
}

TEST(GaitScale, GoesByTheUnitAndRefusesAnUnknownOne) {
  const auto factor = [](std::string_view unit) {
    return ParameterRow{"new", unit, "", &GaitParameters::step_length, 0, 1, 0.1}.factor(4);
  };
  EXPECT_EQ(factor("m"), 4);
  EXPECT_EQ(factor("s"), 2);
  EXPECT_EQ(factor("m/s"), 2);
  EXPECT_EQ(factor("rad/s"), 0.5);
  for (const char* same : {"-", "rad", "m/s^2"}) EXPECT_EQ(factor(same), 1) << same;
  EXPECT_THROW(factor("mm"), std::logic_error);
}

TEST(GaitScale, KeepsTheFroudeNumber) {
  // v^2 / (g h) of the nominal speed.
  for (const Gait& gait : gaits()) {
    const GaitParameters& p = gait.preferred;
    const GaitParameters q = scaled(gait, kTwice).preferred;
    EXPECT_NEAR((q.step_length / q.cycle_time) / (p.step_length / p.cycle_time), 2, 1e-12) << gait.name;
  }
}

TEST(GaitScale, SerialLegsHaveGaitsOfTheirOwnAndRobotsAnOffset) {
  const Gait& trot = find_gait("trot");
  const GaitScale serial{.length = 1, .stance_offset = -0.02, .linkage = LegLinkage::kSerial};
  ASSERT_TRUE(trot.preferred_serial);
  EXPECT_EQ(scaled(trot, serial).preferred.cycle_time, trot.preferred_serial->cycle_time);
  EXPECT_NE(trot.preferred_serial->cycle_time, trot.preferred.cycle_time);
  EXPECT_EQ(scaled(trot, serial).preferred.stance_offset, -0.02);
  // The guide's gaits are one for all.
  const Gait& guide = find_gait("trot:guide");
  EXPECT_EQ(scaled(guide, serial).preferred.cycle_time, guide.preferred.cycle_time);
}

TEST(GaitScale, ScalesWhatChoosesGaitsBySpeed) {
  const MultiGaitOptions options, twice = scaled(options, kTwice);
  ASSERT_EQ(twice.bands.size(), options.bands.size());
  EXPECT_EQ(twice.bands[0].below, 2 * options.bands[0].below);
  EXPECT_EQ(twice.bands[0].gait.preferred.cycle_time, 2 * options.bands[0].gait.preferred.cycle_time);
  EXPECT_EQ(twice.hysteresis, 2 * options.hysteresis);
  EXPECT_EQ(twice.longest_step, 4 * options.longest_step);
  EXPECT_EQ(twice.shortest_cycle, 2 * options.shortest_cycle);
  EXPECT_EQ(twice.limits.max_x, 4 * options.limits.max_x);
}

TEST(GaitScale, ScalesTheTablesRangesAndLeavesStatedOnes) {
  AdaptationRanges stated;
  stated.ranges["step_length"] = {0.1, 0.2};
  stated.delta_scales["cycle_time"] = 0.3;
  const AdaptationRanges twice = scaled(stated, kTwice);
  const ParameterRow height = find_parameter("step_height"), cycle = find_parameter("cycle_time");
  EXPECT_EQ(twice.row("step_height").min, 4 * height.min);
  EXPECT_EQ(twice.row("step_height").max, 4 * height.max);
  EXPECT_EQ(twice.row("step_height").delta_scale, 4 * height.delta_scale);
  EXPECT_EQ(twice.row("cycle_time").max, 2 * cycle.max);
  EXPECT_EQ(twice.row("cycle_time").delta_scale, 0.3);
  EXPECT_EQ(twice.row("step_length").min, 0.1);
  EXPECT_EQ(twice.row("duty_factor").max, find_parameter("duty_factor").max);
}

}  // namespace
}  // namespace crossgait
