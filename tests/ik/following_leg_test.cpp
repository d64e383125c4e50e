// Legs of which a joint follows another: the foot where the robot's kinematics have it, and back.
#include <random>

#include <gtest/gtest.h>

#include "ik/leg_kinematics.h"
#include "tests/ik/serial_robot.h"

namespace crossgait {
namespace {

/// Abduction, hip, knee and an ankle that follows the knee, or a knee that follows the hip and an ankle that
/// follows the knee; the frames turned anyhow.
test::SerialRobot following(bool knee_follows, std::mt19937& random) {
  test::SerialRobot made = test::serial_robot({}, &random);
  Body& knee = made.robot.bodies.back();
  Body toe;
  toe.name = "toe";
  toe.parent = made.joints.knee + 1;
  toe.X_PB.translation() = made.joints.p_BF;
  toe.joint.name = "ankle";
  toe.joint.axis = knee.joint.axis;
  made.joints.p_BF = 0.4 * made.joints.p_BF;
  made.robot.bodies.push_back(toe);
  made.joints.ankle = made.robot.joint_count() - 1;
  made.joints.foot_body = made.joints.ankle + 1;
  made.joints.knee_follows = knee_follows;
  made.robot.couplings.push_back(
      {.follower = made.joints.ankle, .leader = made.joints.knee, .coefficients = {0.1, -0.5}});
  if (knee_follows)
    made.robot.couplings.push_back(
        {.follower = made.joints.knee, .leader = made.joints.hip, .coefficients = {-0.2, -1.5}});
  made.robot.home = JointVector::Zero(made.robot.joint_count());
  made.robot.home[made.joints.hip] = 0.8;
  made.robot.home[made.joints.knee] = -1.4;
  made.robot.place_followers(made.robot.home);
  return made;
}

class FollowingLegs : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(, FollowingLegs, testing::Bool(),
                         [](const auto& p) { return p.param ? "KneeFollows" : "AnkleFollows"; });

TEST_P(FollowingLegs, PutTheFootWhereTheRobotDoes) {
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    const test::SerialRobot made = following(GetParam(), random);
    const LegKinematics leg = make_leg_kinematics(made.robot, Leg::FL, made.joints);
    ASSERT_EQ(leg.kind(), LegKind::kLeastSquares);
    ASSERT_EQ(leg.servo_count(), GetParam() ? 2 : 3);
    ASSERT_EQ(leg.passive_count(), GetParam() ? 2 : 1);
    ServoVector servos(leg.servo_count());
    for (double& angle : servos) angle = test::uniform(random, -1, 1);
    JointVector q = JointVector::Zero(made.robot.joint_count());
    for (int k = 0; k < leg.servo_count(); ++k)
      q[leg.servo_joints()[static_cast<std::size_t>(k)]] = servos[k];
    // The description's joints have no servo marked: all followers are placed.
    made.robot.place_followers(q);
    const LegForward forward = leg.forward(servos);
    // Roundings of a dozen lengths below 1 m.
    ASSERT_LT((leg.origin() + forward.foot - made.foot(q)).norm(), 1e-13) << i;
    for (int k = 0; k < leg.passive_count(); ++k)
      ASSERT_NEAR(forward.passive[k], q[leg.passive_joints()[static_cast<std::size_t>(k)]], 1e-14);
  }
}

TEST_P(FollowingLegs, HaveTheDerivativeAsJacobian) {
  std::mt19937 random(2);
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 100; ++i) {
    const test::SerialRobot made = following(GetParam(), random);
    const LegKinematics leg = make_leg_kinematics(made.robot, Leg::FL, made.joints);
    ServoVector servos(leg.servo_count());
    for (double& angle : servos) angle = test::uniform(random, -1, 1);
    const LegJacobian J = leg.jacobian({servos, leg.forward(servos).passive});
    for (int k = 0; k < leg.servo_count(); ++k) {
      ServoVector more = servos, less = servos;
      more[k] += kStep;
      less[k] -= kStep;
      // step^2 / 6 times a third derivative below 10 m (a knee turns 1.5 times as far): 2e-10; rounding
      // 1e-11.
      ASSERT_LT((J.col(k) - (leg.forward(more).foot - leg.forward(less).foot) / (2 * kStep)).norm(), 1e-9)
          << k;
    }
  }
}

TEST_P(FollowingLegs, ComeBackFromTheFoot) {
  std::mt19937 random(3);
  int missed = 0;
  constexpr int kCount = 200;
  for (int i = 0; i < kCount; ++i) {
    const test::SerialRobot made = following(GetParam(), random);
    const LegKinematics leg = make_leg_kinematics(made.robot, Leg::FL, made.joints);
    // Near home, where there is one posture.
    ServoVector servos(leg.servo_count());
    for (int k = 0; k < leg.servo_count(); ++k)
      servos[k] =
          made.robot.home[leg.servo_joints()[static_cast<std::size_t>(k)]] + test::uniform(random, -0.2, 0.2);
    const Vector3 foot = leg.forward(servos).foot;
    const LegInverse found = leg.inverse(foot);
    if (found.status != IkStatus::kOk) {
      ++missed;
      continue;
    }
    ASSERT_LT((leg.forward(found.posture.servos).foot - foot).norm(), kConverged);
    ASSERT_LT((found.posture.servos - servos).norm(), 1e-6) << i;
    ASSERT_EQ(found.posture.passive.size(), leg.passive_count());
  }
  EXPECT_EQ(missed, 0);
}

TEST(FollowingLeg, KeepsItsServosWhereFollowersAreWithinTheirLimits) {
  std::mt19937 random(4);
  test::SerialRobot made = following(false, random);
  test::set_limits(made.robot, made.joints.ankle, 0.6, 1);  // of 0.1 - 0.5 knee: the knee from -1.8 to -1
  const LegKinematics leg = make_leg_kinematics(made.robot, Leg::FL, made.joints);
  const auto& geometry = *leg.as<LeastSquaresLegGeometry>();
  EXPECT_DOUBLE_EQ(geometry.links[2].limits.lower, -1.8);
  EXPECT_DOUBLE_EQ(geometry.links[2].limits.upper, -1);
}

}  // namespace
}  // namespace crossgait
