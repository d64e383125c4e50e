#include "ik/five_bar_leg.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "physics/robot/multibody.h"
#include "physics/robot_files/data_path.h"
#include "tests/ik/test_leg.h"
#include "tests/support/constants.h"

namespace crossgait {
namespace {

using test::kModes;
using test::kNaN;

/// Random targets around and in the workspace of either side's leg.
Vector3 random_target(std::mt19937& random) {
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  return {uniform(-0.09, 0.09), uniform(-0.09, 0.09), -uniform(0, 0.1)};
}

std::vector<FiveBarGeometry> robot_legs(const char* robot) {
  const LegArray<FiveBarGeometry> legs = five_bar_geometry(load_robot(find_robot(robot)));
  return {legs.begin(), legs.end()};
}

/// Legs without joint limits that bind, those of both robots, and one with odd signs and bent zero postures.
std::vector<FiveBarGeometry> test_legs() {
  std::vector<FiveBarGeometry> legs = robot_legs("scara_quadruped");
  for (const FiveBarGeometry& g : robot_legs("scara_quadruped_long")) legs.push_back(g);
  for (FiveBarGeometry& g : legs) g.tilt_limits = g.a.shoulder_limits = g.b.shoulder_limits = JointLimits{};
  FiveBarGeometry odd = test::hand_made_leg(Leg::FR);
  odd.tilt_sign = 1;
  odd.a.shoulder_sign = odd.b.elbow_sign = -1;
  odd.a.upper_zero = {std::cos(1.0), std::sin(1.0)};
  odd.b.lower_zero = {std::cos(-0.4), std::sin(-0.4)};
  odd.a.upper = 0.05;
  odd.b.lower = 0.065;
  legs.push_back(odd);
  return legs;
}

/// Foot by chain a alone, from tilt, shoulder and elbow: independent of which way the linkage closes.
Vector3 foot_by_chain_a(const FiveBarGeometry& g, const LegAngles& q) {
  const auto plane_angle = [](const Vector2& v) { return std::atan2(v.y(), v.x()); };
  const double upper = plane_angle(g.a.upper_zero) + g.a.shoulder_sign * q.shoulder_left;
  const double lower = upper + plane_angle(g.a.lower_zero) + g.a.elbow_sign * q.elbow_left;
  const double x = g.a.shoulder_x + g.a.upper * std::cos(upper) + g.a.lower * std::cos(lower);
  const double d = g.a.upper * std::sin(upper) + g.a.lower * std::sin(lower);
  const double outward = g.tilt_sign * q.tilt, D = d + g.axis_to_shoulder_down, a = g.axis_to_plane_out;
  return {x, g.side * (a * std::cos(outward) + D * std::sin(outward) - a),
          g.axis_to_shoulder_down + a * std::sin(outward) - D * std::cos(outward)};
}

bool chains_alike(const FiveBarGeometry& g) { return g.a.upper == g.b.upper && g.a.lower == g.b.lower; }

TEST(SolveLeg, ForwardOfInverseIsTheTarget) {
  std::mt19937 random(1);
  int checked = 0, skipped = 0;
  for (const FiveBarGeometry& g : test_legs()) {
    for (const WorkingMode mode : kModes) {
      for (int i = 0; i < 3000; ++i) {
        const Vector3 target = random_target(random);
        const auto [status, q] = solve_leg(g, target, mode);
        if (status != IkStatus::kOk) continue;
        // Chain a alone: a few roundings of 0.1 m, magnified by the root near a straight chain.
        ASSERT_LT((foot_by_chain_a(g, q) - target).norm(), 1e-12);
        if (mode != WorkingMode::kDownUp && !chains_alike(g)) continue;  // may close in two ways
        // An error e of a shoulder moves the closing point by e / sin(parallel): leave out what is next to
        // zero.
        if (leg_margins(g, q).parallel < 2e-3) {
          ++skipped;
          continue;
        }
        ++checked;
        const LegPosition p = forward_leg(g, q.tilt, q.shoulder_left, q.shoulder_right, mode);
        ASSERT_TRUE(p.closed);
        ASSERT_LT((p.foot - target).norm(), 1e-12)
            << target.transpose() << " mode " << static_cast<int>(mode);
        // Elbows come from differences of points, over the link's length, and magnify likewise.
        ASSERT_NEAR(p.elbow_left, q.elbow_left, 1e-10);
        ASSERT_NEAR(p.elbow_right, q.elbow_right, 1e-10);
      }
    }
  }
  EXPECT_GT(checked, 40000);
  EXPECT_LT(skipped, checked / 50);
}

TEST(SolveServos, AreTheLegsServos) {
  std::mt19937 random(7);
  for (const FiveBarGeometry& g : robot_legs("scara_quadruped")) {  // with its joint limits
    for (int i = 0; i < 3000; ++i) {
      const Vector3 target = 1.5 * random_target(random);
      for (const WorkingMode mode : kModes) {
        const LegSolution leg = solve_leg(g, target, mode);
        const ServoSolution servos = solve_servos(g, target, mode);
        ASSERT_EQ(servos.status, leg.status);
        ASSERT_EQ(servos.angles.tilt, leg.angles.tilt);
        ASSERT_EQ(servos.angles.shoulder_left, leg.angles.shoulder_left);
        ASSERT_EQ(servos.angles.shoulder_right, leg.angles.shoulder_right);
      }
    }
  }
}

TEST(SolveLeg, TiltIsTheDesignsEquation) {
  for (const Leg leg : {Leg::FL, Leg::FR}) {
    const FiveBarGeometry g = test::hand_made_leg(leg);
    const double a = 0.024, b = 0.010, side = side_sign(leg);
    for (const double outward : {-0.04, -0.01, 0.0, 0.02, 0.05}) {
      const LegSolution s = solve_leg(g, {0.01, side * outward, -0.05});
      ASSERT_EQ(s.status, IkStatus::kOk);
      const double Y = outward + a, Z = 0.05 + b, D = std::sqrt(Y * Y + Z * Z - a * a);
      // The joint turns about +x: outward is positive on the left, negative on the right. Roundings of angles
      // < 1.
      EXPECT_NEAR(side * s.angles.tilt, std::atan2(Y, Z) - std::atan2(a, D), 1e-15);
    }
  }
}

TEST(SolveLeg, WithoutOffsetsTiltIsTheGuides) {
  FiveBarGeometry g = test::hand_made_leg(Leg::FL);
  g.axis_to_plane_out = g.axis_to_shoulder_down = 0;
  for (const double y : {-0.03, 0.0, 0.01, 0.04}) {
    EXPECT_NEAR(solve_leg(g, {0, y, -0.05}).angles.tilt, std::atan2(y, 0.05),
                1e-15);  // rounding of an angle < 1
  }
}

TEST(SolveLeg, HomePostureIsTheRobotFiles) {
  const RobotDescription robot = load_robot(find_robot("scara_quadruped"));
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    const LegSolution s =
        solve_leg(five_bar_geometry(robot, leg), {0, 0, -0.07});  // "feet .07 m below the shoulders"
    // robot.yaml gives 13 decimals and its loader closes the loops to rounding.
    EXPECT_NEAR(s.angles.tilt, robot.home[model.joint("tilt")], 1e-12);
    EXPECT_NEAR(s.angles.shoulder_left, robot.home[model.joint("shoulder_left")], 1e-12);
    EXPECT_NEAR(s.angles.shoulder_right, robot.home[model.joint("shoulder_right")], 1e-12);
    EXPECT_NEAR(s.angles.elbow_left, robot.home[model.joint("elbow_left")], 1e-12);
    EXPECT_NEAR(s.angles.elbow_right, robot.home[model.joint("elbow_right")], 1e-12);
  }
}

class WholeRobot : public testing::TestWithParam<const char*> {};

TEST_P(WholeRobot, HasItsFeetAtTheTargets) {
  const RobotDescription robot = load_robot(find_robot(GetParam()));
  const LegArray<FiveBarGeometry> legs = five_bar_geometry(robot);
  std::mt19937 random(4);
  RobotState state;
  state.p_WB = {0.3, -0.2, 0.5};
  state.q_WB = from_roll_pitch_yaw(0.1, -0.2, 0.7);
  state.q = state.qd = JointVector::Zero(robot.joint_count());
  std::vector<Pose> poses;
  int checked = 0;
  for (int i = 0; i < 500; ++i) {
    LegArray<Vector3> targets;
    for (const Leg leg : kLegs) {
      LegSolution s;
      do {
        targets[leg] = random_target(random);
        s = solve_leg(legs[leg], targets[leg]);
      } while (s.status != IkStatus::kOk);
      const LegModel& model = (*robot.legs)[leg];
      state.q[model.joint("tilt")] = s.angles.tilt;
      state.q[model.joint("shoulder_left")] = s.angles.shoulder_left;
      state.q[model.joint("shoulder_right")] = s.angles.shoulder_right;
      state.q[model.joint("elbow_left")] = s.angles.elbow_left;
      state.q[model.joint("elbow_right")] = s.angles.elbow_right;
    }
    forward_kinematics(robot, state, poses);
    // The demand on every engine is 1e-9 m; here only roundings of positions below 1 m.
    ASSERT_LT(max_loop_gap(robot, poses), 1e-12);
    for (const Leg leg : kLegs) {
      const Vector3 wanted = state.X_WB() * (legs[leg].p_BL + targets[leg]);
      ASSERT_LT((foot_position(robot, leg, poses) - wanted).norm(), 1e-12) << name(leg);
      ++checked;
    }
  }
  EXPECT_EQ(checked, 2000);
}

INSTANTIATE_TEST_SUITE_P(, WholeRobot, testing::Values("scara_quadruped", "scara_quadruped_long"),
                         [](const auto& p) { return std::string(p.param); });

TEST(SolveLeg, UnreachableTargetsMoveToTheBoundary) {
  const FiveBarGeometry g = test::hand_made_leg(Leg::RL);
  const LegSolution far = solve_leg(g, {0, 0, -0.2});
  EXPECT_EQ(far.status, IkStatus::kClampedTooFar);
  // Straight below, both chains stretched: sqrt(0.105^2 - 0.010^2).
  EXPECT_LT((foot_by_chain_a(g, far.angles) - Vector3(0, 0, -std::sqrt(0.105 * 0.105 - 1e-4))).norm(), 1e-15);
  const LegSolution near = solve_leg(g, {0, 0, -0.001});
  EXPECT_EQ(near.status, IkStatus::kClampedTooNear);
  EXPECT_LT((foot_by_chain_a(g, near.angles) - Vector3(0, 0, -std::sqrt(0.015 * 0.015 - 1e-4))).norm(),
            1e-15);
  // On the tilt axis itself no direction is outward: still an answer.
  EXPECT_EQ(solve_leg(g, {0, -0.024, 0.010}).status, IkStatus::kClampedTooNear);
  // Too near to it and too far along it: the links' reach has the word.
  EXPECT_EQ(solve_leg(g, {0.5, -0.024, 0.010}).status, IkStatus::kClampedTooFar);
}

TEST(SolveLeg, IsContinuousInTheTarget) {
  // Away from the tilt axis by 5 mm and more, 1e-8 m of target move the foot by 1e-8 m, times 0.2 / 0.005
  // where a clamped foot sweeps a longer arc than its target, or by the root of it across the ends of the
  // fold.
  const FiveBarGeometry g = test::hand_made_leg(Leg::FR);
  std::mt19937 random(5);
  std::normal_distribution<double> spread(0, 0.08);
  for (int i = 0; i < 20000; ++i) {
    const Vector3 p(spread(random), spread(random), spread(random));
    // A turn of the tilt joint past half a revolution is no neighbour of its start.
    if (p.z() > -0.005) continue;
    const Vector3 q = p + 1e-8 * Vector3(spread(random), spread(random), spread(random)).normalized();
    const LegSolution at_p = solve_leg(g, p), at_q = solve_leg(g, q);
    ASSERT_LT((foot_by_chain_a(g, at_p.angles) - foot_by_chain_a(g, at_q.angles)).norm(), 5e-5)
        << p.transpose();
  }
}

TEST(SolveLeg, JointLimitsClampAndTheElbowsFollow) {
  FiveBarGeometry g = test::hand_made_leg(Leg::FL);
  const LegSolution wanted = solve_leg(g, {0.02, 0.03, -0.06});
  g.tilt_limits = {-1, 0.9 * wanted.angles.tilt};
  g.b.shoulder_limits = {wanted.angles.shoulder_right + 0.1, 2};
  const LegSolution clamped = solve_leg(g, {0.02, 0.03, -0.06});
  EXPECT_EQ(clamped.status, IkStatus::kClampedJointLimit);
  EXPECT_EQ(clamped.angles.tilt, g.tilt_limits.upper);
  EXPECT_EQ(clamped.angles.shoulder_right, g.b.shoulder_limits.lower);
  EXPECT_EQ(clamped.angles.shoulder_left, wanted.angles.shoulder_left);
  const LegPosition p =
      forward_leg(g, clamped.angles.tilt, clamped.angles.shoulder_left, clamped.angles.shoulder_right);
  ASSERT_TRUE(p.closed);
  EXPECT_LT((foot_by_chain_a(g, clamped.angles) - p.foot).norm(), 1e-15);  // both chains end in one point
  // Too far and past a limit: the first trouble is the one told, and the elbows still follow.
  const LegSolution both = solve_leg(g, {0.12, 0.01, -0.02});
  EXPECT_EQ(both.status, IkStatus::kClampedTooFar);
  EXPECT_EQ(both.angles.shoulder_right, g.b.shoulder_limits.lower);
  const LegPosition q =
      forward_leg(g, both.angles.tilt, both.angles.shoulder_left, both.angles.shoulder_right);
  ASSERT_TRUE(q.closed);
  EXPECT_EQ(both.angles.elbow_left, q.elbow_left);
}

TEST(SolveLeg, NonsenseIsReportedAndFinite) {
  const FiveBarGeometry g = test::hand_made_leg(Leg::FL);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Vector3& bad : {Vector3(kNaN, 0, -0.05), Vector3(0, kNaN, -0.05), Vector3(0, 0, kNaN),
                             Vector3(infinity, 0, -0.05), Vector3(0, 0, infinity)}) {
    for (const WorkingMode mode : kModes) {
      const LegSolution s = solve_leg(g, bad, mode);
      EXPECT_EQ(s.status, IkStatus::kInvalidTarget);
      EXPECT_TRUE(foot_by_chain_a(g, s.angles).allFinite());
      EXPECT_TRUE(std::isfinite(s.angles.shoulder_right) && std::isfinite(s.angles.elbow_right));
    }
  }
  const LegSolution huge = solve_leg(g, {1e300, -1e300, -1e300});
  EXPECT_EQ(huge.status, IkStatus::kClampedTooFar);
  EXPECT_TRUE(foot_by_chain_a(g, huge.angles).allFinite());
}

TEST(LegJacobian, IsTheDerivativeOfTheForwardKinematics) {
  std::mt19937 random(6);
  int checked = 0;
  for (const FiveBarGeometry& g : test_legs()) {
    for (const WorkingMode mode : kModes) {
      if (mode != WorkingMode::kDownUp && !chains_alike(g)) continue;  // may close in two ways
      for (int i = 0; i < 300; ++i) {
        const LegSolution solution = solve_leg(g, random_target(random), mode);
        const LegAngles& q = solution.angles;
        const LegMargins margins = leg_margins(g, q);
        if (solution.status != IkStatus::kOk || margins.parallel < 0.1 || margins.serial < 0.1) continue;
        const auto foot = [&](int joint, double step) {
          return forward_leg(g, q.tilt + (joint == 0 ? step : 0), q.shoulder_left + (joint == 1 ? step : 0),
                             q.shoulder_right + (joint == 2 ? step : 0), mode)
              .foot;
        };
        const Matrix3 J = leg_jacobian(g, q);
        constexpr double kStep = 1e-5;
        for (int joint = 0; joint < 3; ++joint) {
          const Vector3 difference = (foot(joint, kStep) - foot(joint, -kStep)) / (2 * kStep);
          // Central differences err by step^2 / 6 times the third derivative, here below 0.1 m / sin(0.1)^5,
          // and by rounding 1e-17 m / step.
          ASSERT_LT((J.col(joint) - difference).norm(), 1e-6) << joint;
          ++checked;
        }
      }
    }
  }
  EXPECT_GT(checked, 5000);
}

TEST(LegMargins, MeasureTheirAngles) {
  FiveBarGeometry g = test::hand_made_leg(Leg::FL);
  const LegSolution s = solve_leg(g, {0, 0, -0.07});
  // Symmetric posture: knees at the cosine rule's angle, lower links leaning in by half their opening.
  const double r2 = 0.07 * 0.07 + 1e-4;
  const double bend = std::acos((r2 - 0.045 * 0.045 - 0.06 * 0.06) / (2 * 0.045 * 0.06));
  const LegMargins margins = leg_margins(g, s.angles);
  EXPECT_NEAR(margins.serial, std::min(bend, std::acos(-1) - bend), 1e-14);  // roundings of an angle
  const double knee_x = 0.010 + 0.045 * std::sin(-s.angles.shoulder_right);
  const double opening = 2 * std::asin(knee_x / 0.060);  // between the lower links
  EXPECT_NEAR(margins.parallel, std::min(opening, std::acos(-1) - opening), 1e-14);        // as above
  EXPECT_NEAR(margins.joint_limit, std::acos(-1) - std::abs(s.angles.elbow_left), 1e-14);  // as above
  g.b.elbow_limits.upper = s.angles.elbow_right - 0.25;
  EXPECT_NEAR(leg_margins(g, s.angles).joint_limit, -0.25, 1e-15);  // beyond: negative
}

TEST(LegMargins, VanishAtTheSingularities) {
  const FiveBarGeometry g = test::hand_made_leg(Leg::FL);
  // Stretched: the bend is the root of a rounding error relative to 1, 1.5e-8.
  EXPECT_LT(leg_margins(g, solve_leg(g, {0, 0, -0.2}).angles).serial, 1e-7);
  // Both elbows on one point (0, 0.0439), lower links together: parallel. Mode 4 with the foot 0.06 to the
  // right.
  const double depth = std::sqrt(0.045 * 0.045 - 1e-4);
  const LegSolution together = solve_leg(g, {0.06, 0, -depth}, WorkingMode::kBothDown);
  EXPECT_EQ(together.status, IkStatus::kOk);
  EXPECT_LT(leg_margins(g, together.angles).parallel, 1e-14);  // roundings of an angle
}

}  // namespace
}  // namespace crossgait
