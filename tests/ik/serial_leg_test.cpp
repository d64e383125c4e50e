#include "ik/serial_leg.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/ik/serial_robot.h"
#include "tests/support/constants.h"

namespace crossgait {
namespace {

using test::geometry;
using test::kInfinity;
using test::kNaN;
using test::LegAtZero;
using test::SerialRobot;
using test::uniform;

constexpr KneeBranch kBranches[] = {KneeBranch::kForward, KneeBranch::kBackward};

// Roundings of sums of a dozen lengths and offsets below 1 m, each turned a few times. What is asked for is
// 1e-9 m.
constexpr double kSumRounding = 1e-13;

TEST(SolveSerial, IsTheLawOfCosinesOnAPlainLeg) {
  const LegAtZero leg;
  const SerialLegGeometry g = geometry(leg, test::serial_robot(leg));
  const double thigh = 0.21, shin = 0.21, depth = 0.3, a = 0.08;
  const double inner = std::acos((depth * depth + thigh * thigh - shin * shin) / (2 * depth * thigh));
  const double outward = 0.05, Y = a + outward, D = std::sqrt(Y * Y + depth * depth - a * a);
  const double inner_out = std::acos(D / (2 * thigh));
  for (const KneeBranch branch : kBranches) {
    const double sign = branch == KneeBranch::kForward ? 1 : -1;
    const SerialSolution below = solve_serial(g, {0, 0, -depth}, branch);
    EXPECT_EQ(below.status, IkStatus::kOk);
    // About +y a hanging link swings towards -x: a knee forward is a negative hip angle. Roundings of angles
    // < 2.
    EXPECT_NEAR(below.angles.abduction, 0, 1e-15);
    EXPECT_NEAR(below.angles.hip, -sign * inner, 1e-15);
    EXPECT_NEAR(below.angles.knee, sign * 2 * inner, 2e-15);
    const SerialSolution out = solve_serial(g, {0, outward, -depth}, branch);
    EXPECT_NEAR(out.angles.abduction, std::atan2(Y, depth) - std::atan2(a, D), 1e-15);
    EXPECT_NEAR(out.angles.hip, -sign * inner_out, 1e-15);
  }
}

class RandomSerialLegs : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(, RandomSerialLegs, testing::Bool(),
                         [](const auto& p) { return p.param ? "AbductionHipKnee" : "HipKnee"; });

TEST_P(RandomSerialLegs, HaveTheirFootAtTheTargetAndTheirKneeOnItsSide) {
  std::mt19937 random(1);
  for (int i = 0; i < 1500; ++i) {
    const LegAtZero leg = test::random_leg(random, GetParam());
    const SerialRobot made = test::serial_robot(leg, &random);
    const SerialLegGeometry g = geometry(leg, made);
    for (int k = 0; k < 5; ++k) {
      const Vector3 p_BF = test::random_foot(leg, random);
      for (const KneeBranch branch : kBranches) {
        const auto [status, q] = solve_serial(g, p_BF - g.p_BL, branch);
        ASSERT_EQ(status, IkStatus::kOk) << i;
        ASSERT_LT((made.foot(q) - p_BF).norm(), 1e-9) << i;
        ASSERT_LT((g.p_BL + forward_serial(g, q) - p_BF).norm(), 1e-9) << i;
        ASSERT_GE(knee_sign(branch) * knee_bend(g, q.knee), 0) << i;
      }
    }
  }
}

TEST_P(RandomSerialLegs, ForwardIsThatOfTheRobot) {
  std::mt19937 random(2);
  for (int i = 0; i < 1500; ++i) {
    const LegAtZero leg = test::random_leg(random, GetParam());
    const SerialRobot made = test::serial_robot(leg, &random);
    const SerialLegGeometry g = geometry(leg, made);
    const SerialAngles q{GetParam() ? uniform(random, -4, 4) : 0, uniform(random, -4, 4),
                         uniform(random, -4, 4)};
    ASSERT_LT((g.p_BL + forward_serial(g, q) - made.foot(q)).norm(), kSumRounding) << i;
  }
}

TEST_P(RandomSerialLegs, HaveTheDerivativeAsJacobian) {
  std::mt19937 random(3);
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 500; ++i) {
    const LegAtZero leg = test::random_leg(random, GetParam());
    const SerialLegGeometry g = geometry(leg, test::serial_robot(leg, &random));
    const SerialAngles q{uniform(random, -2, 2), uniform(random, -4, 4), uniform(random, -4, 4)};
    const Matrix3 J = serial_jacobian(g, q);
    for (int joint = 0; joint < 3; ++joint) {
      const auto foot = [&](double step) {
        return forward_serial(g, {q.abduction + (joint == 0 ? step : 0), q.hip + (joint == 1 ? step : 0),
                                  q.knee + (joint == 2 ? step : 0)});
      };
      // step^2 / 6 times a third derivative below 1.5 m: 3e-11; rounding 1e-16 m / step: 1e-11.
      ASSERT_LT((J.col(joint) - (foot(kStep) - foot(-kStep)) / (2 * kStep)).norm(), 1e-10) << joint;
    }
  }
}

// Nothing that the links reach in the plane of the result is nearer to the target, and the target lies in
// that plane.
TEST_P(RandomSerialLegs, MoveUnreachableTargetsToTheNearestPoint) {
  std::mt19937 random(4);
  int far = 0, near = 0;
  for (int i = 0; i < 400; ++i) {
    LegAtZero leg = test::random_leg(random, GetParam());
    if (leg.has_abduction)
      leg.hip.z() = leg.abduction.z() - uniform(random, 0, 0.05);  // hip not above the axis
    const SerialLegGeometry g = geometry(leg, test::serial_robot(leg, &random));
    const double reach = leg.thigh() + leg.shin(), hole = std::abs(leg.thigh() - leg.shin());
    const bool beyond = i % 2 == 0;
    const double r = beyond ? uniform(random, reach, 2 * reach) : uniform(random, 0, hole);
    const double angle = uniform(random, -1.4, 1.4);
    const double depth = r * std::cos(angle);
    const Vector3 target =
        test::foot_in_plane(leg, r * std::sin(angle), depth, leg.has_abduction ? uniform(random, -2, 2) : 0) -
        g.p_BL;
    for (const KneeBranch branch : kBranches) {
      const auto [status, q] = solve_serial(g, target, branch);
      ASSERT_EQ(status, beyond ? IkStatus::kClampedTooFar : IkStatus::kClampedTooNear) << i;
      (beyond ? far : near) += 1;
      const Vector3 foot = forward_serial(g, q);
      const double distance = (foot - target).norm();
      // To the edge of the ring, along the ray. Roundings of lengths below 2 m.
      ASSERT_NEAR(distance, beyond ? r - reach : hole - r, 1e-12) << i;
      for (int hip = 0; hip < 90; ++hip) {
        for (int knee = 0; knee < 30; ++knee) {
          const Vector3 other = forward_serial(g, {q.abduction, hip * M_PI / 45, knee * M_PI / 15});
          ASSERT_GT((other - target).norm(), distance - 1e-12) << i;
        }
      }
    }
  }
  EXPECT_EQ(far, 400);
  EXPECT_EQ(near, 400);
}

TEST_P(RandomSerialLegs, AreContinuousInTheTarget) {
  std::mt19937 random(5);
  int checked = 0;
  for (int i = 0; i < 20000; ++i) {
    const LegAtZero leg = test::random_leg(random, GetParam());
    const SerialLegGeometry g = geometry(leg, test::serial_robot(leg, &random));
    const Vector3 p = uniform(random, 0.01, 0.8) * test::random_direction(random);
    const Vector3 q = p + 1e-9 * test::random_direction(random);
    // Nearer than 5 cm to the hip, or 1 cm to the abduction axis, a clamped foot moves by much more than its
    // target.
    double depth = -p.z();
    if (leg.has_abduction) {
      const double a = g.axis_to_plane_out, b = g.axis_to_shoulder_down;
      const double from_axis = std::hypot(g.side * p.y() + a, b - p.z());
      if (from_axis < 0.01) continue;
      depth = std::sqrt(std::max(0.0, from_axis * from_axis - a * a)) - b;
    }
    if (std::hypot(p.x(), depth) < 0.05) continue;
    ++checked;
    // 1e-9 m become their root where the plane begins, 3e-5 m x sqrt(2 x 0.2 m), and ten times that at a fold
    // of 0.5 m.
    const SerialAngles at_p = solve_serial(g, p, KneeBranch::kForward).angles,
                       at_q = solve_serial(g, q, KneeBranch::kForward).angles;
    ASSERT_LT((forward_serial(g, at_p) - forward_serial(g, at_q)).norm(), 2e-4) << i;
  }
  EXPECT_GT(checked, 15000);
}

TEST(SolveSerial, OffThePlaneWithoutAbductionIsTooFar) {
  LegAtZero leg;
  leg.has_abduction = false;
  const SerialLegGeometry g = geometry(leg, test::serial_robot(leg));
  const SerialSolution off = solve_serial(g, {0.05, 0.01, -0.3}, KneeBranch::kForward);
  EXPECT_EQ(off.status, IkStatus::kClampedTooFar);
  EXPECT_LT((forward_serial(g, off.angles) - Vector3(0.05, 0, -0.3)).norm(),
            kSumRounding);  // straight to the plane
  EXPECT_EQ(solve_serial(g, {0.05, 1e-12, -0.3}, KneeBranch::kForward).status, IkStatus::kOk);
  EXPECT_EQ(off.angles.abduction, 0);
}

TEST(SolveSerial, SingularTargetsHaveAnAnswer) {
  LegAtZero leg;
  leg.hip.z() = leg.abduction.z() - 0.03;
  const SerialLegGeometry g = geometry(leg, test::serial_robot(leg));
  const double thigh = leg.thigh(), reach = thigh + leg.shin();
  for (const KneeBranch branch : kBranches) {
    // Straight knee, to the last bit of the reach.
    const SerialSolution straight = solve_serial(g, {0, 0, -reach}, branch);
    EXPECT_LT((forward_serial(g, straight.angles) - Vector3(0, 0, -reach)).norm(), 1e-15);
    EXPECT_NEAR(knee_bend(g, straight.angles.knee), 0, 1e-7);  // the root of a rounding relative to 1
    EXPECT_LT(serial_margins(g, straight.angles).serial, 1e-7);
    // At the hip: folded, the shin straight down if there is anything of it left.
    const SerialSolution hip = solve_serial(g, {0, 0, 0}, branch);
    EXPECT_EQ(hip.status, IkStatus::kClampedTooNear);
    const double hole = std::max(std::abs(thigh - leg.shin()), kSmallestFold);
    EXPECT_LT((forward_serial(g, hip.angles) - Vector3(0, 0, -hole)).norm(), 1e-12);
    // On the abduction axis, where no direction is outward, and inside the circle around it that the plane
    // leaves.
    for (const Vector3& near :
         {Vector3(0.1, -0.08, 0.03), Vector3(0.1, -0.08, -0.02), Vector3(0.1, -0.02, 0.03)}) {
      const SerialSolution axis = solve_serial(g, near, branch);
      EXPECT_EQ(axis.status, IkStatus::kClampedTooNear);
      const Vector3 foot = forward_serial(g, axis.angles);
      EXPECT_NEAR(foot.x(), 0.1, 1e-15);
      // 0.08 m from the axis: as near as the plane comes. Rounding of such lengths.
      EXPECT_NEAR(std::hypot(foot.y() + 0.08, foot.z() - 0.03), 0.08, 1e-15);
      EXPECT_LT(serial_margins(g, axis.angles).serial, 1e-15);
    }
    const Vector3 beside = forward_serial(g, solve_serial(g, {0.1, -0.02, 0.03}, branch).angles);
    EXPECT_LT((beside - Vector3(0.1, 0, 0.03)).norm(), 1e-15);  // straight out, away from the axis
  }
}

TEST(SolveSerial, NonsenseIsReportedAndFinite) {
  for (const bool has_abduction : {false, true}) {
    LegAtZero leg;
    leg.has_abduction = has_abduction;
    const SerialRobot made = test::serial_robot(leg);
    const SerialLegGeometry g = geometry(leg, made);
    for (const Vector3& bad : {Vector3(kNaN, 0, -0.2), Vector3(0, kNaN, -0.2), Vector3(0, 0, kNaN),
                               Vector3(kInfinity, 0, -0.2), Vector3(0, -kInfinity, 0)}) {
      for (const KneeBranch branch : kBranches) {
        const SerialSolution s = solve_serial(g, bad, branch);
        EXPECT_EQ(s.status, IkStatus::kInvalidTarget);
        // Below the hip by 0.7 of the leg.
        EXPECT_LT((forward_serial(g, s.angles) - Vector3(0, 0, -0.7 * 0.42)).norm(), 1e-15);
      }
    }
    const SerialSolution huge = solve_serial(g, {1e300, -1e300, -1e300}, KneeBranch::kForward);
    EXPECT_EQ(huge.status, IkStatus::kClampedTooFar);
    EXPECT_TRUE(made.foot(huge.angles).allFinite());
  }
}

TEST(SolveSerial, JointLimitsClampOneByOneAndAreSaid) {
  const LegAtZero leg;
  SerialRobot made = test::serial_robot(leg);
  const Vector3 target(0.05, 0.06, -0.3);
  const SerialAngles free = solve_serial(geometry(leg, made), target, KneeBranch::kBackward).angles;
  ASSERT_GT(free.abduction, 0.1);
  ASSERT_LT(free.knee, -0.1);
  for (const int joint : made.servos()) {
    SerialRobot limited = made;
    const double angle = joint == 0 ? free.abduction : joint == 1 ? free.hip : free.knee;
    const double limit = angle > 0 ? angle - 0.1 : angle + 0.1;
    test::set_limits(limited.robot, joint, angle > 0 ? -0.5 : limit, angle > 0 ? limit : 0.5);
    const auto [status, q] = solve_serial(geometry(leg, limited), target, KneeBranch::kBackward);
    EXPECT_EQ(status, IkStatus::kClampedJointLimit) << joint;
    EXPECT_EQ(q.abduction, joint == 0 ? limit : free.abduction);
    EXPECT_EQ(q.hip, joint == 1 ? limit : free.hip);
    EXPECT_EQ(q.knee, joint == 2 ? limit : free.knee);
    // Margin to the limit it is at, and beyond it.
    EXPECT_EQ(serial_margins(geometry(leg, limited), q).joint_limit, 0);
    EXPECT_NEAR(serial_margins(geometry(leg, limited), free).joint_limit, -0.1, 1e-15);
  }
  // Out of reach and past a limit: the first trouble is the one told.
  test::set_limits(made.robot, 0, -0.01, 0.01);
  EXPECT_EQ(solve_serial(geometry(leg, made), {0, 0.5, -0.5}, KneeBranch::kForward).status,
            IkStatus::kClampedTooFar);
}

TEST(SolveSerial, AnglesAreTakenByWholeTurnsIntoTheirLimits) {
  LegAtZero leg;
  leg.hip_axis = -Vector3::UnitY();
  SerialRobot made = test::serial_robot(leg);
  const Vector3 target(-0.1, 0.02, -0.3);
  const SerialAngles free = solve_serial(geometry(leg, made), target, KneeBranch::kForward).angles;
  for (const int turns : {-2, -1, 1, 3}) {
    const double angle = free.hip + turns * 2 * M_PI;
    test::set_limits(made.robot, 1, angle - 0.5, angle + 1.5);
    const auto [status, q] = solve_serial(geometry(leg, made), target, KneeBranch::kForward);
    EXPECT_EQ(status, IkStatus::kOk);
    EXPECT_NEAR(q.hip, angle, 1e-14);  // rounding of an angle of 20
  }
  // Limits wider than a turn, as placeholders are: the turn around zero.
  test::set_limits(made.robot, 1, -3, 40);
  EXPECT_EQ(solve_serial(geometry(leg, made), target, KneeBranch::kForward).angles.hip, free.hip);
  // A limit passed on the far side of the middle is met at the nearer end.
  test::set_limits(made.robot, 1, 2.0, 3.0);
  ASSERT_LT(std::abs(free.hip), 1.5);
  EXPECT_EQ(solve_serial(geometry(leg, made), target, KneeBranch::kForward).angles.hip,
            std::cos(free.hip - 2.0) > std::cos(free.hip - 3.0) ? 2.0 : 3.0);
}

TEST(SerialMargins, MeasureTheirAngles) {
  const LegAtZero leg;
  const SerialLegGeometry g = geometry(leg, test::serial_robot(leg));
  const SerialAngles q = solve_serial(g, {0, 0, -0.4}, KneeBranch::kForward).angles;
  const double bend = 2 * std::acos(0.2 / 0.21);
  const LegMargins margins = serial_margins(g, q);
  EXPECT_NEAR(margins.serial, bend, 1e-14);              // roundings of an angle, near its root
  EXPECT_NEAR(margins.joint_limit, M_PI - bend, 1e-14);  // as above
  EXPECT_EQ(margins.parallel, M_PI_2);
  // Knee wide open but the foot beside the axis: D = 0.05 of a leg of 0.42 m.
  const SerialAngles near = solve_serial(g, {0.2, 0, -0.05}, KneeBranch::kForward).angles;
  EXPECT_NEAR(serial_margins(g, near).serial, std::atan(0.05 / 0.42), 1e-14);
}

}  // namespace
}  // namespace crossgait
