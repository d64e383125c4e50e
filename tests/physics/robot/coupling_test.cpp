// Coupled joints of a description: where followers belong, what is refused, and home poses.
#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "physics/engine/world_spec.h"
#include "physics/robot/followed_joint.h"
#include "physics/robot/loop_closing.h"
#include "physics/robot/robot.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/robot_files/scratch_robot.h"

namespace crossgait {
namespace {

JointCoupling coupled(int follower, int leader, double offset, double multiplier) {
  return {.follower = follower, .leader = leader, .coefficients = {offset, multiplier}};
}

TEST(Coupling, IsAPolynomialAndItsDerivative) {
  const JointCoupling coupling{.follower = 1, .leader = 0, .coefficients = {0.1, -2, 0.5, 3, -0.25}};
  const double x = 0.7;
  EXPECT_NEAR(coupling.follower_at(x), 0.1 - 2 * x + 0.5 * x * x + 3 * x * x * x - 0.25 * x * x * x * x,
              1e-15);
  EXPECT_NEAR(coupling.slope_at(x), -2 + x + 9 * x * x - x * x * x, 1e-15);
  EXPECT_FALSE(coupling.is_linear());
  EXPECT_TRUE(coupled(1, 0, 0.3, 2).is_linear());
}

TEST(Coupling, ChainsEndAtWhatIsAskedForOrAtWhoLeadsThemAll) {
  RobotDescription robot = pendulum_chain(4);
  robot.couplings = {coupled(3, 2, 0.1, 2), coupled(2, 0, -0.2, 3)};
  const std::array ends{0, 1};
  const FollowedJoint to_end = follow_couplings(robot, 3, ends);
  EXPECT_TRUE(to_end.is_one_of_them);
  EXPECT_EQ(to_end.joint, 0);
  // 2 (3 q0 - 0.2) + 0.1
  EXPECT_DOUBLE_EQ(to_end.multiplier, 6);
  EXPECT_DOUBLE_EQ(to_end.offset, -0.3);
  EXPECT_EQ(follow_couplings(robot, 1, ends).joint, 1) << "itself included";
  const FollowedJoint elsewhere = follow_couplings(robot, 3, std::array{1});
  EXPECT_FALSE(elsewhere.is_one_of_them);
  EXPECT_EQ(elsewhere.joint, 0);
  EXPECT_EQ(elsewhere.not_linear, nullptr);
  robot.couplings[1].coefficients[2] = 1;
  EXPECT_EQ(follow_couplings(robot, 3, ends).not_linear, &robot.couplings[1]);
  robot.couplings.push_back(coupled(0, 3, 0, 1));
  EXPECT_TRUE(follow_couplings(robot, 3, {}).in_a_circle);
  EXPECT_FALSE(follow_couplings(robot, 1, {}).in_a_circle);
}

TEST(Coupling, FollowersAreInPlaceAlongChainsInAnyOrder) {
  RobotDescription robot = pendulum_chain(4);
  // The last one first: 3 follows 2 follows 0.
  robot.couplings = {coupled(3, 2, 0.1, 1), coupled(2, 0, -0.2, 2)};
  JointVector q(4);
  q << 0.5, 0.3, 9, 9;
  robot.place_followers(q);
  EXPECT_DOUBLE_EQ(q[2], 0.8);
  EXPECT_DOUBLE_EQ(q[3], 0.9);
  EXPECT_EQ(q[0], 0.5);
  EXPECT_EQ(q[1], 0.3);
}

TEST(Coupling, AServoStaysWhereItIs) {
  RobotDescription robot = pendulum_chain(2);
  robot.bodies[2].joint.actuated = true;
  robot.couplings = {coupled(1, 0, 0, 1)};
  JointVector q(2);
  q << 0.5, 0.1;
  robot.place_followers(q);
  EXPECT_EQ(q[1], 0.1);
}

TEST(Coupling, ClosingMovesFollowersAndNotServos) {
  RobotDescription robot = pendulum_chain(3);
  robot.bodies[1].joint.actuated = true;
  robot.couplings = {{.follower = 2, .leader = 1, .coefficients = {0, 1, 0.5}}, coupled(1, 0, 0.1, -1)};
  JointVector q(3);
  q << 0.4, 0, 0;
  close_loops(robot, q);
  EXPECT_EQ(q[0], 0.4);
  EXPECT_NEAR(q[1], -0.3, 1e-15);
  EXPECT_NEAR(q[2], -0.3 + 0.5 * 0.09, 1e-15);
}

TEST(Coupling, WhatMeansNothingIsRefused) {
  const auto refusal = [](std::vector<JointCoupling> couplings, const JointVector& home) {
    RobotDescription robot = pendulum_chain(3);
    robot.couplings = std::move(couplings);
    robot.home = home;
    return config_error([&] { robot.validate(); });
  };
  const JointVector zero = JointVector::Zero(3);
  EXPECT_EQ(refusal({coupled(3, 0, 0, 1)}, zero).found(), "no joint and joint 'link_1_joint'");
  EXPECT_EQ(refusal({coupled(1, 1, 0, 1)}, zero).found(), "joint 'link_2_joint' and joint 'link_2_joint'");
  const ConfigError second = refusal({coupled(1, 0, 0, 1), coupled(1, 2, 0, 1)}, zero);
  EXPECT_EQ(second.element(), "coupling of joint 'link_2_joint'");
  EXPECT_EQ(second.found(), "a second one");
  const ConfigError circle = refusal({coupled(1, 0, 0, 1), coupled(2, 1, 0, 1), coupled(0, 2, 0, 1)}, zero);
  EXPECT_NE(circle.found().find("in a circle"), std::string::npos) << circle.what();
  const ConfigError number = refusal({coupled(1, 0, std::numeric_limits<double>::infinity(), 1)}, zero);
  EXPECT_EQ(number.expected(), "finite coefficients");
  const ConfigError home = refusal({coupled(1, 0, 0.01, 1)}, zero);
  EXPECT_EQ(home.element(), "home");
  EXPECT_EQ(home.found(), "-0.01 rad away");
}

TEST(Coupling, LongerStepsMakeItSofter) {
  RobotDescription robot = pendulum_chain(2);
  robot.couplings = {coupled(1, 0, 0, 1)};
  robot.couplings[0].softness.time_constant = 0.004;
  WorldSpec spec;
  spec.robot = std::make_shared<const RobotDescription>(robot);
  spec.lengthen_time_constants(0.003);
  EXPECT_EQ(spec.robot->couplings[0].softness.time_constant, 0.006);
}

}  // namespace
}  // namespace crossgait
