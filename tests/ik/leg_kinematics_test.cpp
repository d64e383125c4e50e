#include "ik/leg_kinematics.h"

#include <cmath>

#include <gtest/gtest.h>

#include "physics/core/error.h"
#include "physics/robot_files/data_path.h"
#include "tests/ik/serial_robot.h"

namespace crossgait {
namespace {

using test::LegAtZero;
using test::SerialRobot;

std::vector<int> listed(std::span<const int> joints) { return {joints.begin(), joints.end()}; }

TEST(LegKinematics, OfTodaysRobotsIsTheFiveBar) {
  const RobotDescription robot = load_robot(find_robot("scara_quadruped"));
  for (const Leg leg : kLegs) {
    const LegKinematics kinematics = make_leg_kinematics(robot, leg);
    const FiveBarGeometry g = five_bar_geometry(robot, leg);
    const LegModel& model = (*robot.legs)[leg];
    EXPECT_EQ(name(kinematics.kind()), "five_bar");
    EXPECT_EQ(kinematics.origin(), g.p_BL);
    EXPECT_EQ(
        listed(kinematics.servo_joints()),
        (std::vector<int>{model.joint("tilt"), model.joint("shoulder_left"), model.joint("shoulder_right")}));
    EXPECT_EQ(listed(kinematics.passive_joints()),
              (std::vector<int>{model.joint("elbow_left"), model.joint("elbow_right")}));
    for (const Vector3& target : {Vector3(0.01, 0.02, -0.06), Vector3(0, 0, -0.3)}) {
      for (const WorkingMode mode : {WorkingMode::kDownUp, WorkingMode::kBothUp}) {
        const auto [status, posture] = kinematics.inverse(target, {.mode = mode});
        const LegSolution expected = solve_leg(g, target, mode);
        const LegAngles& q = expected.angles;
        EXPECT_EQ(status, expected.status);
        EXPECT_EQ(Vector3(posture.servos), Vector3(q.tilt, q.shoulder_left, q.shoulder_right));
        EXPECT_EQ(Vector2(posture.passive), Vector2(q.elbow_left, q.elbow_right));
        const LegForward forward = kinematics.forward(posture.servos, {.mode = mode});
        const LegPosition position = forward_leg(g, q.tilt, q.shoulder_left, q.shoulder_right, mode);
        EXPECT_EQ(forward.closed, position.closed);
        EXPECT_EQ(forward.foot, position.foot);
        EXPECT_EQ(Vector2(forward.passive), Vector2(position.elbow_left, position.elbow_right));
        EXPECT_EQ(Matrix3(kinematics.jacobian(posture)), leg_jacobian(g, q));
        EXPECT_EQ(kinematics.margins(posture).parallel, leg_margins(g, q).parallel);
        EXPECT_EQ(kinematics.margins(posture).joint_limit, leg_margins(g, q).joint_limit);
      }
    }
  }
  // Lower links too short to meet.
  FiveBarGeometry apart = five_bar_geometry(robot, Leg::FL);
  apart.a.lower = apart.b.lower = 0.02;
  const LegKinematics short_links(apart, (*robot.legs)[Leg::FL]);
  EXPECT_FALSE(short_links.forward(Vector3(0, 1.5, -1.5)).closed);
}

/// Straight or oblique, with two or three joints; home with its knee backward.
struct Made {
  LegAtZero leg;
  SerialRobot made;

  Made(bool has_abduction, bool oblique) {
    leg.has_abduction = has_abduction;
    if (oblique) leg.knee_axis = Vector3(0.05, 1, 0.05).normalized();
    made = test::serial_robot(leg);
    made.robot.home = JointVector::Zero(made.joint_count());
    made.robot.home[made.joints.hip] = 0.7;
    made.robot.home[made.joints.knee] = -1.4;
  }
  LegKinematics kinematics() const { return make_leg_kinematics(made.robot, leg.leg, made.joints); }
};

class SerialLegKinematics : public testing::TestWithParam<std::tuple<bool, bool>> {};
INSTANTIATE_TEST_SUITE_P(, SerialLegKinematics, testing::Combine(testing::Bool(), testing::Bool()),
                         [](const auto& p) {
                           return std::string(std::get<0>(p.param) ? "ThreeJoints" : "TwoJoints") +
                                  (std::get<1>(p.param) ? "Oblique" : "Straight");
                         });

TEST_P(SerialLegKinematics, IsOneVocabulary) {
  const auto [has_abduction, oblique] = GetParam();
  const Made robot(has_abduction, oblique);
  const LegKinematics kinematics = robot.kinematics();
  EXPECT_EQ(name(kinematics.kind()), oblique ? "least_squares" : "serial");
  EXPECT_EQ(kinematics.servo_count(), has_abduction ? 3 : 2);
  EXPECT_EQ(listed(kinematics.servo_joints()), robot.made.servos());
  EXPECT_EQ(kinematics.passive_count(), 0);
  EXPECT_TRUE(kinematics.passive_joints().empty());
  JointVector q = robot.made.robot.home;
  q[0] += 0.1;
  const Vector3 p_BF = robot.made.foot(q);
  for (const KneeBranch knee : {KneeBranch::kForward, KneeBranch::kBackward}) {
    const auto [status, posture] = kinematics.inverse(p_BF - kinematics.origin(), {.knee = knee});
    if (oblique && !has_abduction && knee == KneeBranch::kForward) {
      // Two oblique joints have the foot on a surface, and this point of it with one knee only.
      EXPECT_EQ(status, IkStatus::kClampedTooFar);
      continue;
    }
    ASSERT_EQ(status, IkStatus::kOk);
    ASSERT_EQ(posture.servos.size(), kinematics.servo_count());
    ASSERT_EQ(posture.passive.size(), 0);
    JointVector angles = JointVector::Zero(robot.made.joint_count());
    for (int i = 0; i < kinematics.servo_count(); ++i) {
      angles[kinematics.servo_joints()[static_cast<std::size_t>(i)]] = posture.servos[i];
    }
    EXPECT_LT((robot.made.foot(angles) - p_BF).norm(), 1e-9);
    const LegForward forward = kinematics.forward(posture.servos);
    EXPECT_TRUE(forward.closed);
    EXPECT_EQ(forward.passive.size(), 0);
    EXPECT_LT((kinematics.origin() + forward.foot - p_BF).norm(), 1e-9);
    // Differences of the whole robot's foot. step^2 / 6 times a third derivative below 0.5 m, and 1e-16 m /
    // step.
    const LegJacobian J = kinematics.jacobian(posture);
    ASSERT_EQ(J.cols(), kinematics.servo_count());
    constexpr double kStep = 1e-5;
    for (int i = 0; i < J.cols(); ++i) {
      const JointVector step = kStep * JointVector::Unit(angles.size(), i);
      const Vector3 slope = (robot.made.foot(angles + step) - robot.made.foot(angles - step)) / (2 * kStep);
      EXPECT_LT((J.col(i) - slope).norm(), 1e-10) << i;
    }
    // The knee is bent by about its angle at home; the closed form also sees the abduction's lever, 0.42 m
    // cos(0.7) over a leg of 0.42 m.
    const double serial = has_abduction && !oblique ? std::atan(std::cos(0.7)) : 1.4;
    EXPECT_NEAR(kinematics.margins(posture).serial, serial, 0.15);
    EXPECT_GT(kinematics.margins(posture).joint_limit, 0.5);
  }
}

TEST(MakeLegKinematics, TheGeometryIsAtHand) {
  const LegKinematics serial = Made(true, false).kinematics();
  ASSERT_NE(serial.as<SerialLegGeometry>(), nullptr);
  EXPECT_EQ(serial.as<FiveBarGeometry>(), nullptr);
  EXPECT_EQ(serial.as<LeastSquaresLegGeometry>(), nullptr);
  EXPECT_NEAR(serial.as<SerialLegGeometry>()->chain.upper, 0.21, 1e-15);  // rounding of a difference
}

TEST(MakeLegKinematics, LeastSquaresBeginAtHome) {
  const Made robot(true, true);
  const LegKinematics kinematics = robot.kinematics();
  EXPECT_EQ(kinematics.as<LeastSquaresLegGeometry>()->start(KneeBranch::kBackward),
            LegJointAngles(0, 0.7, -1.4));
}

TEST(MakeLegKinematics, LeastSquaresNeedAHome) {
  Made robot(true, true);
  robot.made.robot.home.resize(0);
  EXPECT_THROW((void)robot.kinematics(), ConfigError);
}

}  // namespace
}  // namespace crossgait
