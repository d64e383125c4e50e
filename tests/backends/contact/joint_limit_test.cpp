// Rows of joint limits, against what the laws say of one joint. What they do to motions:
// conformance/joint_limits.cpp.
#include "backends/contact/joint_limit.h"

#include <gtest/gtest.h>

namespace crossgait::contact {
namespace {

constexpr double kStep = 1e-3;

LimitedJoint joint_within(double lower, double upper) {
  return {0, lower, upper, 10, SoftLaw(Softness{}, kStep)};
}

TEST(JointLimit, AHardOneLetsTheAngleGetAsFarAndNoFurther) {
  const LimitedJoint joint = joint_within(-1, 1);
  const auto upper = limit_row(joint, true, 0.999, 2, 3, kStep);
  ASSERT_TRUE(upper);
  EXPECT_EQ(upper->away, -1);
  EXPECT_EQ(upper->R, 0);
  EXPECT_NEAR(upper->target, -1, 1e-12);  // 1 mrad in a step of 1 ms
  const auto lower = limit_row(joint, true, -0.998, -2, -3, kStep);
  ASSERT_TRUE(lower);
  EXPECT_EQ(lower->away, 1);
  EXPECT_NEAR(lower->target, -2, 1e-12);
  EXPECT_FALSE(limit_row(joint, true, 0.5, 2, 3, kStep));  // out of reach
}

TEST(JointLimit, OfAHardOnesViolationAFifthIsUndoneAndNoFaster) {
  const LimitedJoint joint = joint_within(-1, 1);
  EXPECT_NEAR(limit_row(joint, true, 1.0005, 0, 0, kStep)->target, 0.1, 1e-12);
  EXPECT_EQ(limit_row(joint, true, 1.1, 0, 0, kStep)->target, kFastestReturn);
  EXPECT_EQ(limit_row(joint, true, -1.1, 0, 0, kStep)->target, kFastestReturn);
}

TEST(JointLimit, TheOneAheadCountsWhereBothAreNear) {
  const LimitedJoint joint = joint_within(-0.01, 0.01);
  EXPECT_EQ(limit_row(joint, true, -0.001, 30, 30, kStep)->away, -1);
  EXPECT_EQ(limit_row(joint, true, 0.001, -30, -30, kStep)->away, 1);
}

// v* = v - h (B v + K imp r) and R = (1 - imp) / imp / I, with imp at its largest beyond the width.
TEST(JointLimit, ASoftOneIsASpringAndDamperFromTheLimitOn) {
  const LimitedJoint joint = joint_within(-1, 1);
  EXPECT_FALSE(limit_row(joint, false, 1, 5, 5, kStep));
  const auto row = limit_row(joint, false, 1.01, 0.5, 9, kStep);
  ASSERT_TRUE(row);
  EXPECT_EQ(row->away, -1);
  const double imp = 0.95, T = 0.02, B = 2 / (imp * T), K = 1 / (imp * imp * T * T);
  EXPECT_NEAR(row->R, (1 - imp) / imp * 10, 1e-12);
  EXPECT_NEAR(row->target, -0.5 - kStep * (B * -0.5 + K * imp * -0.01), 1e-12);
}

}  // namespace
}  // namespace crossgait::contact
