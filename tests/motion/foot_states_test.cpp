#include "motion/foot_states.h"

#include <gtest/gtest.h>

#include "physics/core/error.h"
#include "physics/robot/multibody.h"
#include "scenes/robots.h"
#include "scenes/scenes.h"

namespace crossgait {
namespace {

RobotState moved(const RobotState& state, double dt) {
  RobotState after = state;
  after.p_WB += dt * state.v_WB;
  const double angle = dt * state.w_WB.norm();
  after.q_WB = Quaternion(Eigen::AngleAxisd(angle, state.w_WB.normalized())) * state.q_WB;
  after.q += dt * state.qd;
  return after;
}

TEST(FootStates, AreThoseOfForwardKinematicsAndItsDerivative) {
  const auto robot = scenes::quadruped();
  const FootKinematics kinematics(*robot);
  std::mt19937 random(1);
  std::vector<Pose> poses;
  FootStates feet, before, after;
  for (int i = 0; i < 50; ++i) {
    const RobotState state = scenes::random_state(*robot, random);
    kinematics.update(state, feet);
    forward_kinematics(*robot, state, poses);
    constexpr double kStep = 1e-6;
    kinematics.update(moved(state, -kStep), before);
    kinematics.update(moved(state, kStep), after);
    for (const Leg leg : kLegs) {
      EXPECT_LT((feet.p_WF[leg] - foot_position(*robot, leg, poses)).norm(), 1e-14);  // rounding
      const Vector3 difference = (after.p_WF[leg] - before.p_WF[leg]) / (2 * kStep);
      EXPECT_LT((feet.v_WF[leg] - difference).norm(), 1e-7);  // rounding over the step
    }
  }
}

TEST(FootStates, NeedLegs) { EXPECT_THROW(FootKinematics{*scenes::sled()}, ConfigError); }

}  // namespace
}  // namespace crossgait
