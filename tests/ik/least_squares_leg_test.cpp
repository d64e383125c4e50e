#include "ik/least_squares_leg.h"

#include <cmath>

#include <gtest/gtest.h>

#include "physics/core/error.h"
#include "tests/ik/serial_robot.h"
#include "tests/support/constants.h"

namespace crossgait {
namespace {

using test::LegAtZero;
using test::make_oblique;
using test::SerialRobot;
using test::uniform;

constexpr KneeBranch kBothBranches[] = {KneeBranch::kForward, KneeBranch::kBackward};

/// Angles of a posture with its foot well below the hip and its knee well bent, from the closed form of the
/// leg with straight axes.
LegJointAngles bent_posture(const LegAtZero& straight, std::mt19937& random, KneeBranch branch) {
  const SerialLegGeometry g = serial_leg_geometry(test::serial_robot(straight).robot, straight.leg,
                                                  test::serial_robot(straight).joints);
  const double near = std::abs(straight.thigh() - straight.shin()), far = straight.thigh() + straight.shin();
  const double r = near + uniform(random, 0.3, 0.8) * (far - near), angle = uniform(random, -0.5, 0.5);
  const Vector3 p = test::foot_in_plane(straight, r * std::sin(angle), r * std::cos(angle),
                                        straight.has_abduction ? uniform(random, -0.4, 0.4) : 0);
  const SerialAngles q = solve_serial(g, p - g.p_BL, branch).angles;
  return straight.has_abduction ? LegJointAngles(q.abduction, q.hip, q.knee)
                                : LegJointAngles(q.hip, q.knee, 0);
}

Vector3 foot_of(const SerialRobot& made, const LegJointAngles& q) {
  JointVector angles = JointVector::Zero(made.joint_count());
  for (int i = 0; i < made.joint_count(); ++i)
    angles[i] = q[i];  // the builder's joints are the leg's, in order
  return made.foot(angles);
}

/// A leg as those of robots: the hip not above the abduction axis by more than its links are long.
LegAtZero robot_leg(std::mt19937& random, bool has_abduction) {
  LegAtZero leg = test::random_leg(random, has_abduction);
  leg.hip.z() = leg.abduction.z() - uniform(random, -0.01, 0.05);
  return leg;
}

class LeastSquaresLegs : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(, LeastSquaresLegs, testing::Bool(),
                         [](const auto& p) { return p.param ? "ThreeJoints" : "TwoJoints"; });

TEST_P(LeastSquaresLegs, ForwardIsThatOfTheRobot) {
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    LegAtZero leg = robot_leg(random, GetParam());
    const LegJointAngles home = bent_posture(leg, random, KneeBranch::kForward);
    make_oblique(leg, uniform(random, 0, 1), random);
    const SerialRobot made = test::serial_robot(leg, &random);
    LeastSquaresLegGeometry g;
    try {
      g = least_squares_leg_geometry(made.robot, leg.leg, made.joints, home);
    } catch (const ConfigError&) {
      continue;  // about such axes home's knee happens to be straight
    }
    const LegJointAngles q(uniform(random, -4, 4), uniform(random, -4, 4),
                           GetParam() ? uniform(random, -4, 4) : 0);
    // Roundings of a dozen lengths below 1 m.
    ASSERT_LT((g.p_BL + forward_least_squares(g, q) - foot_of(made, q)).norm(), 1e-13) << i;
    // The leg frame begins on the hip axis, where that is nearest to the foot with this axis level.
    Pose X = Pose::Identity();
    if (GetParam() && std::abs(leg.hip_axis.z()) > 0.02) {
      X = Eigen::Translation3d(leg.abduction) *
          Eigen::AngleAxisd(levelling_angle(leg.abduction_axis, leg.hip_axis), leg.abduction_axis) *
          Eigen::Translation3d(-leg.abduction);
    }
    const Vector3 hip_axis = X.linear() * leg.hip_axis;
    ASSERT_LT(std::abs((X * leg.foot - g.p_BL).dot(hip_axis)), 1e-13);
    ASSERT_LT((g.p_BL - X * leg.hip).cross(hip_axis).norm(), 1e-13);
  }
}

TEST_P(LeastSquaresLegs, HaveTheDerivativeAsJacobian) {
  std::mt19937 random(2);
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 300; ++i) {
    LegAtZero leg = robot_leg(random, GetParam());
    const LegJointAngles home = bent_posture(leg, random, KneeBranch::kForward);
    make_oblique(leg, 0.1, random);
    const SerialRobot made = test::serial_robot(leg, &random);
    const LeastSquaresLegGeometry g = least_squares_leg_geometry(made.robot, leg.leg, made.joints, home);
    const LegJointAngles q = home + 2 * test::random_direction(random);
    const Matrix3 J = least_squares_jacobian(g, q);
    for (int joint = 0; joint < g.count; ++joint) {
      const auto foot = [&](double step) {
        return forward_least_squares(g, q + step * LegJointAngles::Unit(joint));
      };
      // step^2 / 6 times a third derivative below 1.5 m: 3e-11; rounding 1e-16 m / step: 1e-11.
      ASSERT_LT((J.col(joint) - (foot(kStep) - foot(-kStep)) / (2 * kStep)).norm(), 1e-10) << joint;
    }
    if (g.count == 2) {
      ASSERT_EQ(J.col(2), Vector3::Zero());
    }
  }
}

// On legs that the closed form covers it is the same posture.
TEST_P(LeastSquaresLegs, AgreeWithTheClosedForm) {
  std::mt19937 random(3);
  int over_the_top = 0;
  for (int i = 0; i < 1000; ++i) {
    const LegAtZero leg = robot_leg(random, GetParam());
    const SerialRobot made = test::serial_robot(leg, &random);
    const SerialLegGeometry closed = serial_leg_geometry(made.robot, leg.leg, made.joints);
    for (const KneeBranch branch : kBothBranches) {
      const LegJointAngles home = bent_posture(leg, random, branch);
      const LeastSquaresLegGeometry g = least_squares_leg_geometry(made.robot, leg.leg, made.joints, home);
      ASSERT_LT((g.p_BL - closed.p_BL).norm(), 1e-14);  // rounding of lengths below 1 m
      ASSERT_EQ(g.start(branch), home);
      const LegJointAngles wanted = bent_posture(leg, random, branch);
      const Vector3 target = foot_of(made, wanted) - g.p_BL;
      const LeastSquaresSolution found = solve_least_squares(g, target, branch);
      ASSERT_EQ(found.status, IkStatus::kOk) << i;
      const SerialSolution exact = solve_serial(closed, target, branch);
      ASSERT_EQ(exact.status, IkStatus::kOk) << i;
      const SerialAngles q = GetParam() ? SerialAngles{found.angles[0], found.angles[1], found.angles[2]}
                                        : SerialAngles{0, found.angles[0], found.angles[1]};
      ASSERT_LT((forward_serial(closed, q) - forward_serial(closed, exact.angles)).norm(), 1e-9) << i;
      // The leg may also be turned over the abduction axis, with its foot above that in its plane.
      if (GetParam() && std::abs(std::remainder(q.abduction - exact.angles.abduction, 2 * M_PI)) > 1) {
        ++over_the_top;
        continue;
      }
      // By what the smallest motion of the foot per rad is, here above 0.01 m: 1e-10 m / 0.01 m.
      const auto turn = [](double a, double b) { return std::abs(std::remainder(a - b, 2 * M_PI)); };
      ASSERT_LT(turn(q.knee, exact.angles.knee), 1e-7) << i;
      ASSERT_LT(turn(q.hip, exact.angles.hip), 1e-7) << i;
      ASSERT_LT(turn(q.abduction, exact.angles.abduction), 1e-7) << i;
      ASSERT_NEAR(knee_bend(g, found.angles), knee_bend(closed, exact.angles.knee), 1e-7) << i;
    }
  }
  EXPECT_LE(over_the_top, 20);  // of 2000
}

TEST_P(LeastSquaresLegs, PutTheFootOfObliqueLegsOnItsTarget) {
  std::mt19937 random(4);
  int most = 0;
  for (int i = 0; i < 1000; ++i) {
    LegAtZero leg = robot_leg(random, GetParam());
    const LegAtZero straight = leg;
    make_oblique(leg, 5 / kDegreesPerRadian, random);
    const SerialRobot made = test::serial_robot(leg, &random);
    EXPECT_FALSE(is_serial_leg(made.robot, leg.leg, made.joints));
    for (const KneeBranch branch : kBothBranches) {
      const LegJointAngles home = bent_posture(straight, random, branch);
      const LeastSquaresLegGeometry g = least_squares_leg_geometry(made.robot, leg.leg, made.joints, home);
      const LegJointAngles wanted = bent_posture(straight, random, branch);
      const Vector3 p_BF = foot_of(made, wanted);
      const auto [status, q, iterations] = solve_least_squares(g, p_BF - g.p_BL, branch);
      ASSERT_EQ(status, IkStatus::kOk) << i;
      ASSERT_LT((foot_of(made, q) - p_BF).norm(), 1e-9) << i;
      ASSERT_GT(knee_sign(branch) * knee_bend(g, q), 0) << i;
      most = std::max(most, iterations);
    }
  }
  EXPECT_LE(most, 5 * 60);
}

TEST(LeastSquaresLeg, StartsOfBothBranchesHaveOneFoot) {
  std::mt19937 random(5);
  int same = 0;
  for (int i = 0; i < 300; ++i) {
    LegAtZero leg = robot_leg(random, true);
    const LegJointAngles home = bent_posture(leg, random, KneeBranch::kBackward);
    make_oblique(leg, 0.05, random);
    const SerialRobot made = test::serial_robot(leg, &random);
    const LeastSquaresLegGeometry g = least_squares_leg_geometry(made.robot, leg.leg, made.joints, home);
    EXPECT_EQ(g.start(KneeBranch::kBackward), home);
    EXPECT_LT(knee_bend(g, home), 0);
    const LegJointAngles& other = g.start(KneeBranch::kForward);
    EXPECT_GT(knee_bend(g, other), 0);
    // Two solutions of one target.
    same += (forward_least_squares(g, other) - forward_least_squares(g, home)).norm() < 1e-9 ? 1 : 0;
  }
  EXPECT_GE(same, 295);  // next to the edge a leg about oblique axes has one alone
}

/// A leg hanging down, home with its knee backward.
struct PlainLeg {
  LegAtZero leg;
  SerialRobot made;
  LegJointAngles home{0.1, 0.7, -1.4};

  explicit PlainLeg(double oblique = 0) {
    std::mt19937 random(6);
    make_oblique(leg, oblique, random);
    made = test::serial_robot(leg);
  }
  LeastSquaresLegGeometry geometry() const {
    return least_squares_leg_geometry(made.robot, leg.leg, made.joints, home);
  }
};

/// The nearest foot of a grid over all joints within their limits, refined four times around the best, of
/// postures with their knee on this side.
double nearest_by_sampling(const LeastSquaresLegGeometry& g, const Vector3& target, KneeBranch branch) {
  constexpr int kSamples = 24;
  LegJointAngles best = LegJointAngles::Zero(), low, high;
  for (int i = 0; i < 3; ++i) {
    low[i] = g.links[static_cast<std::size_t>(i)].limits.lower;
    high[i] = g.links[static_cast<std::size_t>(i)].limits.upper;
  }
  double least = 1e9;
  LegJointAngles from = low, width = high - low;
  for (int round = 0; round < 5; ++round) {
    for (int n = 0; n < kSamples * kSamples * kSamples; ++n) {
      const int row = n / kSamples, layer = row / kSamples;
      const Vector3 u(n % kSamples, row % kSamples, layer);
      const LegJointAngles q = (from + u.cwiseProduct(width) / (kSamples - 1)).cwiseMax(low).cwiseMin(high);
      const double distance = (forward_least_squares(g, q) - target).norm();
      if (distance < least && knee_sign(branch) * knee_bend(g, q) >= 0) {
        least = distance;
        best = q;
      }
    }
    width /= 6;
    from = best - width / 2;
  }
  return least;
}

TEST(SolveLeastSquares, OutOfReachIsTheNearestPosture) {
  std::mt19937 random(7);
  for (const double oblique : {0.0, 0.1}) {
    const LeastSquaresLegGeometry g = PlainLeg(oblique).geometry();
    for (int i = 0; i < 15; ++i) {
      const double angle = uniform(random, -0.8, 0.8), r = uniform(random, 0.45, 0.9);
      const Vector3 target(r * std::sin(angle), uniform(random, -0.2, 0.2), -r * std::cos(angle));
      for (const KneeBranch branch : kBothBranches) {
        const LeastSquaresSolution s = solve_least_squares(g, target, branch);
        ASSERT_EQ(s.status, IkStatus::kClampedTooFar) << i;
        const double distance = (forward_least_squares(g, s.angles) - target).norm();
        ASSERT_LT(distance, nearest_by_sampling(g, target, branch) + 1e-9) << i;
        if (oblique > 0) continue;
        // The nearest posture has a straight knee: to the root of what 1e-15 m are to 0.1 m.
        ASSERT_LT(least_squares_margins(g, s.angles).serial, 1e-6) << i;
      }
    }
  }
}

TEST(SolveLeastSquares, InsideTheFoldIsTooNear) {
  PlainLeg plain(0.02);
  plain.made.joints.p_BF *= 0.5;  // a shin half as long as the thigh
  LeastSquaresLegGeometry g = plain.geometry();
  g.links[0].limits = {-0.5, 0.5};  // not over the top, where another posture is nearer
  for (const KneeBranch branch : kBothBranches) {
    const LeastSquaresSolution s = solve_least_squares(g, {0.02, 0.01, -0.03}, branch);
    EXPECT_EQ(s.status, IkStatus::kClampedTooNear);
    EXPECT_LT((forward_least_squares(g, s.angles) - Vector3(0.02, 0.01, -0.03)).norm(),
              nearest_by_sampling(g, {0.02, 0.01, -0.03}, branch) + 1e-9);
  }
  g.links[0].limits = {-3, 3};
  // Inside the circle around the abduction axis that the leg's plane leaves.
  EXPECT_EQ(solve_least_squares(g, {0.15, -0.06, 0.01}, KneeBranch::kBackward).status,
            IkStatus::kClampedTooNear);
}

TEST(SolveLeastSquares, JointLimitsHoldAndAreSaid) {
  const PlainLeg plain(0.05);
  const LegJointAngles wanted(0.4, 1.1, -1.9);
  const LeastSquaresLegGeometry free = plain.geometry();
  const Vector3 target = forward_least_squares(free, wanted);
  ASSERT_EQ(solve_least_squares(free, target, plain.home).status, IkStatus::kOk);
  for (int joint = 0; joint < 3; ++joint) {
    // Everything else is bounded, too, so that no detour leads there.
    LeastSquaresLegGeometry g = free;
    for (int i = 0; i < 3; ++i) {
      g.links[static_cast<std::size_t>(i)].limits = {wanted[i] - 1.5, wanted[i] + 1.5};
    }
    JointLimits& limits = g.links[static_cast<std::size_t>(joint)].limits;
    const double before = wanted[joint] > 0 ? wanted[joint] - 0.15 : wanted[joint] + 0.15;
    (wanted[joint] > 0 ? limits.upper : limits.lower) = before;
    const LeastSquaresSolution s = solve_least_squares(g, target, plain.home);
    EXPECT_EQ(s.status, IkStatus::kClampedJointLimit) << joint;
    EXPECT_GE(least_squares_margins(g, s.angles).joint_limit, 0) << joint;
    EXPECT_LT(least_squares_margins(g, s.angles).joint_limit, 1e-12) << joint;  // at the limit, to rounding
    EXPECT_LT((forward_least_squares(g, s.angles) - target).norm(),
              nearest_by_sampling(g, target, KneeBranch::kBackward) + 1e-9);
  }
}

TEST(SolveLeastSquares, AnyStartLeadsThere) {
  const PlainLeg plain(0.05);
  LeastSquaresLegGeometry g = plain.geometry();
  const Vector3 target = forward_least_squares(g, {0.2, 0.5, -1.2});
  // Straight, folded, on the target's own line (no joint moves the foot towards it), out of limits, nonsense.
  for (const LegJointAngles& start :
       {LegJointAngles(0, 0, 0), LegJointAngles(0.2, -0.1, 0), LegJointAngles(0, 1, M_PI),
        LegJointAngles(9, -9, 50), LegJointAngles(test::kNaN, 0.3, test::kInfinity)}) {
    const LeastSquaresSolution s = solve_least_squares(g, target, start);
    EXPECT_EQ(s.status, IkStatus::kOk) << start.transpose();
    EXPECT_LT((forward_least_squares(g, s.angles) - target).norm(), 1e-10);
    EXPECT_GE(least_squares_margins(g, s.angles).joint_limit, 0);
  }
  // The knee can bend one way only and starts at the end of it, straight.
  g.links[2].limits = {-2.5, 0};
  EXPECT_EQ(solve_least_squares(g, target, LegJointAngles(0, 0, 1)).status, IkStatus::kOk);
}

TEST(SolveLeastSquares, IsDeterministic) {
  const LeastSquaresLegGeometry g = PlainLeg(0.05).geometry();
  for (const Vector3& target : {Vector3(0.05, 0.02, -0.3), Vector3(0.1, 0, -2)}) {
    const LeastSquaresSolution a = solve_least_squares(g, target, KneeBranch::kForward),
                               b = solve_least_squares(g, target, KneeBranch::kForward);
    EXPECT_EQ(a.angles, b.angles);
    EXPECT_EQ(a.iterations, b.iterations);
  }
}

TEST(SolveLeastSquares, NonsenseIsReportedAndFinite) {
  const PlainLeg plain(0.05);
  const LeastSquaresLegGeometry g = plain.geometry();
  for (const Vector3& bad : {Vector3(test::kNaN, 0, -0.2), Vector3(0, test::kInfinity, -0.2)}) {
    const LeastSquaresSolution s = solve_least_squares(g, bad, KneeBranch::kBackward);
    EXPECT_EQ(s.status, IkStatus::kInvalidTarget);
    EXPECT_EQ(s.angles, plain.home);
  }
  const LeastSquaresSolution huge = solve_least_squares(g, {1e300, -1e300, -1e300}, KneeBranch::kBackward);
  EXPECT_EQ(huge.status, IkStatus::kClampedTooFar);
  // As far as squares do not overflow, along every axis.
  EXPECT_EQ(huge.angles, solve_least_squares(g, {1e3, -1e3, -1e3}, KneeBranch::kBackward).angles);
  EXPECT_LT(least_squares_margins(g, huge.angles).serial,
            0.1);  // stretched: with oblique axes about straight
}

TEST(SolveLeastSquares, OffTheSurfaceOfTwoJointsIsTooFar) {
  LegAtZero leg;
  leg.has_abduction = false;
  const SerialRobot made = test::serial_robot(leg);
  const LeastSquaresLegGeometry g =
      least_squares_leg_geometry(made.robot, leg.leg, made.joints, {0.7, -1.4, 0});
  std::mt19937 random(8);
  for (int i = 0; i < 50; ++i) {
    const Vector3 on(uniform(random, -0.1, 0.1), 0, uniform(random, -0.35, -0.2));
    const LeastSquaresSolution s =
        solve_least_squares(g, on + Vector3(0, 0.01, 0), LegJointAngles(0.7, -1.4, 5));
    ASSERT_EQ(s.status, IkStatus::kClampedTooFar);
    ASSERT_LT((forward_least_squares(g, s.angles) - on).norm(),
              1e-8);  // the root of 1e-15 m x 0.01 m, and less
    ASSERT_EQ(s.angles[2], 0);
  }
}

// The joint ranges of a robot of 12 kg, with axes 5 degrees off: from home to everywhere.
TEST(SolveLeastSquares, ReachesAlmostEverythingWithinTheLimits) {
  std::mt19937 random(9);
  int missed = 0;
  for (int i = 0; i < 2000; ++i) {
    LegAtZero leg;
    make_oblique(leg, 5 / kDegreesPerRadian, random);
    SerialRobot made = test::serial_robot(leg);
    test::set_limits(made.robot, 0, -0.86, 0.86);
    test::set_limits(made.robot, 1, -0.69, 4.5);
    test::set_limits(made.robot, 2, -2.8, -0.89);
    const LeastSquaresLegGeometry g =
        least_squares_leg_geometry(made.robot, leg.leg, made.joints, {0, 0.7, -1.4});
    const LegJointAngles q(uniform(random, -0.86, 0.86), uniform(random, -0.69, 4.5),
                           uniform(random, -2.8, -0.89));
    const LeastSquaresSolution s = solve_least_squares(g, forward_least_squares(g, q), KneeBranch::kBackward);
    ASSERT_GE(least_squares_margins(g, s.angles).joint_limit, 0);
    ASSERT_LE(s.iterations, 6 * 60);
    if (s.status == IkStatus::kOk) continue;
    ++missed;
    ASSERT_EQ(s.status, IkStatus::kClampedJointLimit);
  }
  EXPECT_LE(missed, 20);  // measured: 2 in 1000
}

TEST(LeastSquaresLegGeometry, NeedsAHomeWithABentKneeAndAFootOffItsAxis) {
  for (const LegJointAngles& home : {LegJointAngles(0, 0.5, 0.04), LegJointAngles(0, 0.5, M_PI - 0.04),
                                     LegJointAngles(test::kNaN, 0.5, -1)}) {
    PlainLeg plain;
    plain.home = home;
    try {
      (void)plain.geometry();
      FAIL() << "no error";
    } catch (const ConfigError& e) {
      EXPECT_EQ(e.source(), "made.urdf");
      EXPECT_NE(e.element().find("leg FL home"), std::string::npos) << e.what();
    }
  }
  for (const double bend : {0.06, -0.06, M_PI - 0.06}) {  // just enough
    PlainLeg plain;
    plain.home = LegJointAngles(0, 0.5, bend);
    EXPECT_NO_THROW((void)plain.geometry()) << bend;
  }
  PlainLeg on_axis;
  on_axis.made.joints.p_BF = Vector3(0, 0.1, 0);
  EXPECT_THROW((void)on_axis.geometry(), ConfigError);
  PlainLeg broken;
  broken.made.robot.bodies[3].parent = 0;
  EXPECT_THROW((void)broken.geometry(), ConfigError);
}

}  // namespace
}  // namespace crossgait
