// Servo torques, what stands before them, and whether steps are short enough for them.
#include <algorithm>
#include <cmath>
#include <utility>

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

TEST(Servo, DampersAtAStepsEndAreArmatureToTheStep) {
  Joint joint;
  joint.armature = 0.01, joint.damping = 4;
  EXPECT_EQ(step_armature(joint, 0.005), 0.01);
  joint.implicit_joint_damping = 0.5;
  EXPECT_DOUBLE_EQ(step_armature(joint, 0.005), 0.01 + 0.01);
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

// The law written with the angle and speed at which the step ends.
TEST(ImplicitServo, IsTheLawOfTheStepsEnd) {
  constexpr double kStep = 4e-3;
  Joint joint = one_servo().joint(0);
  joint.kp = 60, joint.kd = 3, joint.effort_limit = 20, joint.effort_negative = 7;
  for (const auto& [s, d] : {std::pair(1.0, 1.0), {0.0, 1.0}, {1.0, 0.0}, {0.3, 0.8}}) {
    joint.implicit_stiffness = s, joint.implicit_damping = d;
    ASSERT_TRUE(is_implicit(joint));
    for (const double target : {-0.4, 0.0, 0.3}) {
      const double q = 0.1, v = -2;
      const auto servo = implicit_servo(joint, 3, target, q, v, kStep);
      ASSERT_TRUE(servo);
      EXPECT_EQ(servo->joint, 3);
      for (const double a : {-900.0, -20.0, 0.0, 55.0, 900.0}) {
        const double end = v + kStep * a;
        const double wanted = joint.kp * (target - q - s * kStep * end) - joint.kd * ((1 - d) * v + d * end);
        EXPECT_NEAR(servo->torque_at(a), std::clamp(wanted, -7.0, 20.0), 1e-12) << s << " " << d << " " << a;
      }
    }
  }
}

TEST(ImplicitServo, IsExplicitWhereNothingIsImplicit) {
  Joint joint = one_servo().joint(0);
  EXPECT_FALSE(is_implicit(joint));
  joint.implicit_damping = 1;  // of a damping of 0
  EXPECT_FALSE(is_implicit(joint));
  joint.kd = 1;
  EXPECT_TRUE(is_implicit(joint));
  joint.actuated = false;
  EXPECT_FALSE(is_implicit(joint));
}

TEST(ImplicitServo, HasNoTorqueWithinThePlayNorBeyondItsSpeed) {
  Joint joint = one_servo().joint(0);
  joint.kd = 1, joint.implicit_stiffness = joint.implicit_damping = 1, joint.backlash = 0.1;
  EXPECT_FALSE(implicit_servo(joint, 0, 0.04, 0, 3, 1e-3));
  const auto pushing = implicit_servo(joint, 0, 0.25, 0, 0, 1e-3);
  ASSERT_TRUE(pushing);
  EXPECT_DOUBLE_EQ(pushing->torque, 10 * 0.2);
  EXPECT_EQ(pushing->lower, 0) << "it would pull back through the play";
  EXPECT_EQ(implicit_servo(joint, 0, -0.25, 0, 0, 1e-3)->upper, 0);
  joint.backlash = 0, joint.no_load_speed = 2;
  const auto braking = implicit_servo(joint, 0, 1, 0, 5, 1e-3);
  ASSERT_TRUE(braking);
  EXPECT_EQ(braking->upper, 0);
  EXPECT_EQ(braking->lower, -5) << "a drive brakes with all its torque";
}

TEST(ImplicitServo, IsBesideTheTorquesOfDrives) {
  RobotDescription robot = one_servo();
  robot.bodies[1].joint.implicit_stiffness = 1;
  Drives drives(robot, 1e-3);
  RobotState state;
  state.q = state.qd = JointVector::Zero(1);
  JointVector torques = JointVector::Zero(1);
  drives.add_torques({JointVector::Constant(1, 0.2)}, state, torques);
  EXPECT_EQ(torques[0], 0);
  ASSERT_EQ(drives.implicit().size(), 1U);
  EXPECT_DOUBLE_EQ(drives.implicit()[0].torque, 2);
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

TEST(ServoLoop, OfAnImplicitServoIsStableAtAnyGain) {
  RobotDescription robot = one_servo();
  Joint& joint = robot.bodies[1].joint;
  for (const double gain : {1e2, 1e4, 1e6}) {
    joint.kp = 100 * gain, joint.kd = gain;
    joint.implicit_stiffness = joint.implicit_damping = 1;
    const double ratio = stiffest_servo_loop(robot, 0.005)->ratio;
    EXPECT_LT(ratio, 2) << gain;
    // A step of it, and of its criterion, as above.
    double q = 1e-3, qd = 0;
    for (int i = 0; i < 1000; ++i) {
      qd = (0.03 * qd - 0.005 * joint.kp * q) / (0.03 + 0.005 * joint.kd + 0.005 * 0.005 * joint.kp);
      q += 0.005 * qd;
    }
    EXPECT_LT(std::abs(q), 1e-3) << gain;
    joint.implicit_stiffness = joint.implicit_damping = 0;
    EXPECT_GT(stiffest_servo_loop(robot, 0.005)->ratio, 2) << gain;
  }
}

}  // namespace
}  // namespace crossgait
