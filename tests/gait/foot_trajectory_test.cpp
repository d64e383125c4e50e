#include "gait/foot_trajectory.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/gait/test_robot.h"

namespace crossgait {
namespace {

/// Cubic Bezier by Bernstein polynomials.
double bernstein(double u, double p0, double p1, double p2, double p3) {
  const double v = 1 - u;
  return v * v * v * p0 + 3 * v * v * u * p1 + 3 * v * u * u * p2 + u * u * u * p3;
}

Vector3 target(const GaitParameters& p, bool swing, double progress, Leg leg = Leg::FL) {
  return foot_position(p, leg, {0, swing, progress}, {{p.step_length, 0}, 1, p.swing});
}

TEST(BezierSwing, IsTheGuidesCurve) {
  for (const GaitParameters& p : {guide_parameters(), GaitParameters{}}) {
    const double s = p.step_length / 2, h = p.body_height, k = p.swing_shape;
    const double l = std::max(h - p.step_height - p.foot_clearance, 1e-4);
    for (double u = 0; u <= 1; u += 0.01) {
      const Vector3 foot = target(p, true, u);
      EXPECT_NEAR(foot.x(), bernstein(u, -s, -s * k, s * k, s), 1e-16);  // roundings of centimetres
      EXPECT_NEAR(foot.z(), -bernstein(u, h, l, l, h), 1e-16);           // as above
    }
  }
}

TEST(BezierSwing, ReachesThreeQuartersOfItsLiftAndLandsMovingForward) {
  EXPECT_EQ(bezier_swing(0.5, 0.35).lift, 0.75);
  EXPECT_GT(bezier_swing(1, 0.35).along, bezier_swing(1 - 1e-6, 0.35).along);
}

TEST(BezierSwing, ClampsItsShape) {
  EXPECT_EQ(bezier_swing(0.3, 2).along, bezier_swing(0.3, 0.95).along);
  EXPECT_EQ(bezier_swing(0.3, -1).along, bezier_swing(0.3, 0.05).along);
}

TEST(MatchedSwing, ReachesItsLift) {
  for (const double duty : {0.4, 0.5, 0.75}) {
    EXPECT_EQ(matched_swing(0.5, duty).lift, 1);
    for (double u = 0; u <= 1; u += 0.01) EXPECT_LE(matched_swing(u, duty).lift, 1);
  }
}

TEST(MatchedSwing, LiftsOffAndLandsWithTheGround) {
  constexpr double kStep = 1e-6;
  for (const double duty : {0.4, 0.5, 0.75}) {
    // In swing progress u the ground passes two half steps per stance, (1 - duty) / duty of it per swing.
    const double ground = -2 * (1 - duty) / duty;
    for (const auto& [u0, u1] : {std::pair(0.0, kStep), std::pair(1 - kStep, 1.0)}) {
      const StridePoint a = matched_swing(u0, duty), b = matched_swing(u1, duty);
      // One-sided differences err by step / 2 times the second derivative, below 50.
      EXPECT_NEAR((b.along - a.along) / kStep, ground, 50 * kStep);
      EXPECT_NEAR((b.lift - a.lift) / kStep, 0, 50 * kStep);
    }
  }
}

class Path : public testing::TestWithParam<SwingCurve> {
 protected:
  GaitParameters parameters() const {
    GaitParameters p = guide_adaptive_parameters();
    p.swing = GetParam();
    return p;
  }
};

TEST_P(Path, IsClosed) {
  const GaitParameters p = parameters();
  EXPECT_EQ(target(p, true, 0), target(p, false, 1));
  EXPECT_EQ(target(p, true, 1), target(p, false, 0));
  EXPECT_EQ(target(p, true, 0).x(), -p.step_length / 2);
  EXPECT_EQ(target(p, false, 0).z(), -p.body_height);
}

TEST_P(Path, StanceIsAStraightSweepAtConstantSpeedAndDepth) {
  const GaitParameters p = parameters();
  for (double w = 0; w <= 1; w += 0.125) {
    const Vector3 foot = target(p, false, w);
    EXPECT_NEAR(foot.x(), p.step_length * (0.5 - w), 1e-17);  // roundings of centimetres
    EXPECT_EQ(foot.z(), -p.body_height);
  }
  EXPECT_EQ(nominal_speed(p), 0.06 / 0.4);
}

TEST_P(Path, IsMirroredBetweenSidesAndBackwards) {
  GaitParameters p = parameters();
  for (const bool swing : {true, false}) {
    for (double u = 0; u <= 1; u += 0.1) {
      const Vector3 left = target(p, swing, u, Leg::FL), right = target(p, swing, u, Leg::FR);
      EXPECT_EQ(left.x(), right.x());
      EXPECT_EQ(left.y(), -right.y());
      const FootStride back{{-p.step_length, 0}, 1, p.swing};
      const Vector3 reverse = foot_position(p, Leg::FL, {0, swing, u}, back);
      EXPECT_EQ(reverse.x(), -left.x());
      EXPECT_EQ(reverse.z(), left.z());
    }
  }
}

TEST_P(Path, FollowsItsStepVectorSideways) {
  const GaitParameters p = parameters();
  const FootStride diagonal{{0.03, -0.04}, 1, p.swing};
  for (const bool swing : {true, false}) {
    for (double u = 0; u <= 1; u += 0.1) {
      const Vector3 foot = foot_position(p, Leg::RR, {0, swing, u}, diagonal);
      const Vector3 forward = foot_position(p, Leg::RR, {0, swing, u}, {{0.03, 0}, 1, p.swing});
      EXPECT_EQ(foot.x(), forward.x());
      EXPECT_NEAR(foot.y() - forward.y(), -0.04 / 0.03 * forward.x(), 1e-16);  // roundings of centimetres
      EXPECT_EQ(foot.z(), forward.z());
    }
  }
}

TEST_P(Path, MovesNoMoreThanItsParametersDo) {
  // What "a parameter change never moves a target by more than the change itself" needs of the formulas.
  const GaitParameters p = parameters();
  for (const ParameterRow& row : gait_parameters()) {
    GaitParameters q = p;
    const double change = (row.max - row.min) / 10;
    q.*row.member = p.*row.member + change > row.max ? p.*row.member - change : p.*row.member + change;
    for (const bool swing : {true, false}) {
      for (double u = 0; u <= 1; u += 0.02) {
        EXPECT_LE((target(q, swing, u) - target(p, swing, u)).norm(), change * (1 + 1e-12)) << row.name;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, Path, testing::Values(SwingCurve::kBezier, SwingCurve::kMatched),
                         [](const auto& p) { return std::string(name(p.param)); });

TEST(SwingLift, StopsShortOfTheShoulders) {
  GaitParameters p;
  p.step_height = 0.09;
  EXPECT_EQ(swing_lift(p), p.body_height - 1e-4);
  p.step_height = 0.03;
  EXPECT_EQ(swing_lift(p), p.step_height + p.foot_clearance);
}

TEST(OutwardShift, IsHalfTheStanceWidthPlusTheLegsOffset) {
  GaitParameters p = guide_adaptive_parameters();
  p.lateral_offset_fl = 0.001;
  p.lateral_offset_fr = 0.002;
  p.lateral_offset_rl = 0.003;
  p.lateral_offset_rr = 0.004;
  for (const Leg leg : kLegs) {
    const double expected = 0.04 + 0.001 * (1 + static_cast<double>(index(leg)));
    EXPECT_NEAR(outward_shift(p, leg), expected, 1e-17);  // rounding of centimetres
    EXPECT_EQ(target(p, false, 0.5, leg).y(), side_sign(leg) * outward_shift(p, leg));
  }
}

TEST(FootSpacing, IsNotTheStanceWidth) {
  GaitParameters p = guide_adaptive_parameters();
  p.lateral_offset_rl = 0.005;
  const FootSpacing spacing = foot_spacing(p, test::leg_origins());
  // Leg planes 0.124 apart, every foot 0.04 outward of its own.
  EXPECT_NEAR(spacing.front, 0.204, 1e-15);  // roundings of tenths of a metre
  EXPECT_NEAR(spacing.rear, 0.209, 1e-15);   // as above
}

}  // namespace
}  // namespace crossgait
