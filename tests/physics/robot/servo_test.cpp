// Servo torques, what stands before them, and whether steps are short enough for them.
#include <cmath>

#include <gtest/gtest.h>

#include "physics/robot/actuator.h"
#include "physics/robot/drives.h"
#include "physics/robot/servo_stability.h"

namespace crossgait {
namespace {

/// A base, and on it a rod that turns about y.
RobotDescription one_servo() {
  RobotDescription robot;
  robot.bodies.resize(2);
  robot.bodies[0].inertia = {1e6, Vector3::Zero(), 1e6 * Matrix3::Identity()};
  Body& rod = robot.bodies[1];
  rod.parent = 0;
  rod.inertia = {1, Vector3::Zero(), 0.03 * Matrix3::Identity()};
  rod.joint.axis = Vector3::UnitY();
  rod.joint.actuated = true;
  rod.joint.kp = 10;
  rod.joint.effort_limit = 5;
  robot.home = JointVector::Zero(1);
  return robot;
}

TEST(Servo, TorqueLimitsMayDifferByDirection) {
  Joint joint = one_servo().joint(0);
  EXPECT_EQ(servo_torque(joint, -1, 0, 0), -5);
  joint.effort_negative = 2;
  EXPECT_EQ(servo_torque(joint, -1, 0, 0), -2);
  EXPECT_EQ(servo_torque(joint, 1, 0, 0), 5);
}

TEST(Servo, TargetsAreClippedToItsRangeAndThenToTheLimits) {
  Joint joint;
  EXPECT_EQ(clip_target(joint, 2), 2);
  EXPECT_EQ(clip_target(joint, 9), joint.upper);
  joint.target_lower = -0.2, joint.target_upper = 0.2;
  EXPECT_EQ(clip_target(joint, -1), -0.2);
  joint.upper = -0.6;  // apart from the range
  EXPECT_EQ(clip_target(joint, -1), -0.6);
}

TEST(Servo, SpringsPullToTheirReference) {
  Joint joint;
  joint.damping = 0.5, joint.stiffness = 40, joint.spring_reference = -1.2;
  EXPECT_DOUBLE_EQ(passive_torque(joint, 0.3, 2), -0.5 * 2 - 40 * 1.5);
}

// After n steps what is held is short of a step of the target by exp(-n dt / lag); it acts from the step
// after the one in which it was set.
TEST(Servo, WhatItHoldsFollowsTheTarget) {
  RobotDescription robot = one_servo();
  robot.bodies[1].joint.lag = 0.02;
  constexpr double kStep = 1e-3;
  Drives drives(robot, kStep);
  RobotState state;
  state.q = state.qd = JointVector::Zero(1);
  JointTargets targets;
  targets.q = JointVector::Zero(1);
  const auto torque = [&](Drives& of) {
    JointVector torques = JointVector::Zero(1);
    of.add_torques(targets, state, torques);
    return torques[0];
  };
  EXPECT_EQ(torque(drives), 0);
  targets.q[0] = 0.4;
  for (int n = 0; n < 50; ++n) {
    // Rounding of fifty products.
    EXPECT_NEAR(torque(drives), 10 * 0.4 * (1 - std::exp(-n * kStep / 0.02)), 1e-13) << n;
  }
  std::vector<double> saved;
  drives.save(saved);
  Drives other(robot, kStep);
  other.restore(saved);
  EXPECT_EQ(torque(drives), torque(other));
}

// One joint on a base that cannot be moved: kd dt / I + kp dt^2 / (2 I), I that of the rod and the rotor. A
// base of 1e6 kg gives way by 1e-8 of that.
TEST(ServoLoop, OfOneJointIsItsDampingOverItsInertia) {
  RobotDescription robot = one_servo();
  Joint& joint = robot.bodies[1].joint;
  joint.kd = 3, joint.damping = 1, joint.armature = 0.01;
  const auto loop = stiffest_servo_loop(robot, 0.005);
  ASSERT_TRUE(loop);
  EXPECT_EQ(loop->joint, 0);
  EXPECT_NEAR(loop->inertia, 0.04, 1e-7);
  EXPECT_NEAR(loop->ratio, 4 * 0.005 / 0.04 + 10 * 0.005 * 0.005 / 2 / 0.04, 1e-6);
  joint.kp = joint.kd = joint.damping = 0;
  EXPECT_FALSE(stiffest_servo_loop(robot, 0.005));
}

// The criterion against what it is one of: a step of semi-implicit Euler, a thousand times.
TEST(ServoLoop, IsUnstableFromTwoOn) {
  constexpr double kStep = 0.005, kInertia = 0.03;
  for (const double kd : {11.8, 12.0}) {
    RobotDescription robot = one_servo();
    robot.bodies[1].joint.kp = 40, robot.bodies[1].joint.kd = kd;
    const double ratio = stiffest_servo_loop(robot, kStep)->ratio;
    double q = 1e-3, qd = 0;
    for (int i = 0; i < 1000; ++i) {
      qd += kStep / kInertia * (-40 * q - kd * qd);
      q += kStep * qd;
    }
    EXPECT_EQ(std::abs(q) < 1e-3, ratio < 2) << kd << ": " << ratio;
  }
}

}  // namespace
}  // namespace crossgait
