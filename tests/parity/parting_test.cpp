// When two runs go different ways: of motions made by hand.
#include "parity/parting.h"

#include <gtest/gtest.h>

namespace crossgait {
namespace {

constexpr double kLeg = 0.2;  // m

RobotState at(double time, const Vector3& position, double yaw = 0) {
  RobotState state;
  state.time = time;
  state.p_WB = position;
  state.q_WB = Quaternion(Eigen::AngleAxisd(yaw, Vector3::UnitZ()));
  return state;
}

TEST(Parting, IsMeasuredFromHowTheTwoStand) {
  PartingWatch watch(kLeg);
  // One stands a fifth of a leg length lower, all the time.
  for (int i = 0; i < 100; ++i) {
    const double x = 0.01 * i;
    watch.add(at(0.5 + 0.01 * i, {x, 0, kLeg}), at(0.5 + 0.01 * i, {x, 0, 0.8 * kLeg}));
  }
  EXPECT_NEAR(watch.found().standing_m, 0.2 * kLeg, 1e-15);  // rounding of the subtraction
  EXPECT_EQ(watch.found().standing_rad, 0);
  EXPECT_FALSE(watch.found().time_s.has_value());
}

TEST(Parting, IsWhereTheyHaveMovedByATwentiethOfALegLength) {
  PartingWatch watch(kLeg);
  // 1 mm a step: 10 mm are the bound itself, so the eleventh step is beyond it.
  for (int i = 0; i < 100; ++i)
    watch.add(at(0.5 + 0.01 * i, {0, 0, 0}), at(0.5 + 0.01 * i, {0, 1e-3 * i, 0}));
  ASSERT_TRUE(watch.found().time_s.has_value());
  // Ten millimetres may be beyond the bound by rounding.
  EXPECT_GE(*watch.found().time_s, 0.10 - 1e-12);
  EXPECT_LE(*watch.found().time_s, 0.11 + 1e-12);
}

TEST(Parting, IsAlsoATurn) {
  PartingWatch watch(kLeg);
  for (int i = 0; i < 100; ++i) {
    // They stand a tenth of a radian apart, and one turns by a thousandth a step.
    watch.add(at(0.01 * i, {0, 0, 0}), at(0.01 * i, {0, 0, 0}, 0.1 + 1e-3 * i));
  }
  EXPECT_NEAR(watch.found().standing_rad, 0.1, 1e-15);  // rounding of the angle
  ASSERT_TRUE(watch.found().time_s.has_value());
  EXPECT_NEAR(*watch.found().time_s, 0.51, 0.01 + 1e-12);  // beyond 0.05 rad, or at it by rounding
}

TEST(Parting, OfNoLegLengthIsNone) {
  PartingWatch watch(0);
  watch.add(at(0, {0, 0, 0}), at(0, {0, 0, 0}));
  watch.add(at(1, {0, 0, 0}), at(1, {9, 0, 0}));
  EXPECT_FALSE(watch.found().time_s.has_value());
}

}  // namespace
}  // namespace crossgait
