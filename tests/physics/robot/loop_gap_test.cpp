#include "physics/robot/loop_gap.h"

#include <cmath>

#include <gtest/gtest.h>

#include "physics/robot/multibody.h"
#include "scenes/scenes.h"

namespace crossgait {
namespace {

double gap_of_poses(const RobotDescription& robot, const RobotState& state) {
  std::vector<Pose> poses;
  forward_kinematics(robot, state, poses);
  return max_loop_gap(robot, poses);
}

TEST(LoopGaps, AreThoseOfForwardKinematics) {
  std::mt19937 random(1);
  for (const scenes::RobotPtr& robot :
       {scenes::quadruped(), scenes::long_quadruped(), scenes::awkward_robot()}) {
    const LoopGaps gaps(*robot);
    for (int i = 0; i < 200; ++i) {
      RobotState state = scenes::random_state(*robot, random);
      state.p_WB.setZero();  // so that rounding is that of the robot's own size
      const double expected = gap_of_poses(*robot, state);
      EXPECT_GT(expected, 1e-3) << robot->name;  // random joints leave no loop closed
      // A dozen rotations of vectors of a tenth of a metre: 10 * 1e-16 * 0.1 m, and as much again in poses.
      EXPECT_NEAR(gaps.largest(state.q), expected, 1e-15) << robot->name;
    }
  }
}

TEST(LoopGaps, AnElbowOffByAnAngleOpensItsLoopByTheChord) {
  for (const scenes::RobotPtr& robot : {scenes::quadruped(), scenes::long_quadruped()}) {
    const LoopGaps gaps(*robot);
    ASSERT_LT(gaps.largest(robot->home), 1e-9);  // what validate() grants of a pose whose loops are closed
    for (const Leg leg : kLegs) {
      const int elbow = (*robot->legs)[leg].joint("elbow_left"), body = elbow + 1;
      double radius = 0;  // of the loop's point about the elbow
      for (const LoopClosure& loop : robot->loops) {
        if (loop.body_a != body && loop.body_b != body) continue;
        const Vector3& axis = robot->joint(elbow).axis;
        const Vector3& p = loop.body_a == body ? loop.p_AP : loop.p_BP;
        radius = (p - p.dot(axis) * axis).norm();
      }
      ASSERT_GT(radius, 0.01);
      for (const double angle : {1e-3, 0.3, -1.0}) {
        JointVector q = robot->home;
        q[elbow] += angle;
        EXPECT_NEAR(gaps.largest(q), 2 * radius * std::sin(std::abs(angle) / 2), 2e-9)
            << name(leg);  // home's
      }
    }
  }
}

TEST(LoopGaps, AreNoneWithoutLoops) {
  std::mt19937 random(1);
  for (const scenes::RobotPtr& robot : {scenes::without_loops(scenes::quadruped()), scenes::millipede()})
    EXPECT_EQ(LoopGaps(*robot).largest(scenes::random_state(*robot, random).q), 0);
  EXPECT_EQ(LoopGaps(*scenes::sled()).largest(JointVector()), 0);
}

}  // namespace
}  // namespace crossgait
