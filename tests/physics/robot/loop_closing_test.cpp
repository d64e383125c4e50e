#include "physics/robot/loop_closing.h"

#include <cmath>

#include <gtest/gtest.h>

#include "physics/robot/multibody.h"
#include "tests/physics/robot_files/scratch_robot.h"

namespace crossgait {
namespace {

double gap(const RobotDescription& robot, const JointVector& q) {
  RobotState state;
  state.q = q;
  std::vector<Pose> poses;
  forward_kinematics(robot, state, poses);
  return max_loop_gap(robot, poses);
}

TEST(LoopClosing, MovesOnlyPassiveJointsAndKeepsTheWorkingMode) {
  const RobotDescription robot = load_robot(kRobotFolder + "robot.yaml");
  JointVector q = robot.home;
  for (const LegModel& leg : *robot.legs) {
    q[leg.joint("tilt")] = 0.2;
    q[leg.joint("shoulder_left")] += 0.1;
    q[leg.joint("shoulder_right")] += 0.05;
  }
  const JointVector before = q;
  ASSERT_GT(gap(robot, q), 1e-3);
  close_loops(robot, q);
  EXPECT_LT(gap(robot, q), 1e-15);  // rounding of lengths of 0.1 m
  for (const int joint : robot.actuated_joints()) EXPECT_EQ(q[joint], before[joint]);
  for (const LegModel& leg : *robot.legs) {
    EXPECT_LT(q[leg.joint("elbow_left")], 0);  // knees stay outward
    EXPECT_GT(q[leg.joint("elbow_right")], 0);
  }
}

TEST(LoopClosing, FindsTheTriangleByHand) {
  // Both shoulders straight down: the elbows are 0.020 apart, the lower links meet half way between them.
  const RobotDescription robot = load_robot(kRobotFolder + "robot.yaml");
  JointVector q = JointVector::Zero(robot.joint_count());
  for (const LegModel& leg : *robot.legs) {
    q[leg.joint("elbow_left")] = -0.1;
    q[leg.joint("elbow_right")] = 0.1;
  }
  close_loops(robot, q);
  for (const LegModel& leg : *robot.legs) {
    EXPECT_NEAR(q[leg.joint("elbow_left")], -std::asin(0.010 / 0.060), 1e-14);  // rounding
    EXPECT_NEAR(q[leg.joint("elbow_right")], std::asin(0.010 / 0.060), 1e-14);
  }
}

TEST(LoopClosing, LeavesTheGapOfALoopThatCannotClose) {
  RobotDescription robot = load_robot(kRobotFolder + "robot.yaml");
  robot.loops[0].p_AP.y() += 0.01;  // out of the plane in which the leg moves
  JointVector q = robot.home;
  close_loops(robot, q);
  EXPECT_NEAR(gap(robot, q), 0.01, 1e-14);  // the best there is; rounding
}

}  // namespace
}  // namespace crossgait
