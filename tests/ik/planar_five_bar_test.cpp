// Five-bars without a tilt, whose shoulders may have one axis.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "ik/leg_kinematics.h"
#include "physics/robot/multibody.h"
#include "scenes/scenes.h"

namespace crossgait {
namespace {

class PlanarFiveBar : public ::testing::TestWithParam<double> {
 protected:
  const scenes::RobotPtr robot_ = scenes::planar_five_bars(GetParam());

  Vector3 foot_at(Leg leg, const LegKinematics& kinematics, const LegPosture& posture) const {
    RobotState state;
    state.q = robot_->home;
    for (int i = 0; i < 2; ++i) {
      state.q[kinematics.servo_joints()[static_cast<std::size_t>(i)]] = posture.servos[i];
      state.q[kinematics.passive_joints()[static_cast<std::size_t>(i)]] = posture.passive[i];
    }
    std::vector<Pose> poses;
    forward_kinematics(*robot_, state, poses);
    // Both lower links end there.
    const LegModel& model = (*robot_->legs)[leg];
    const Vector3 left = poses[static_cast<std::size_t>(model.joint("elbow_left")) + 1] * model.p_BF;
    const Vector3 right = poses[static_cast<std::size_t>(model.joint("elbow_right")) + 1] * model.p_BF;
    EXPECT_LT((left - right).norm(), 1e-12) << "the loop is open";
    return left - kinematics.origin();
  }
};
INSTANTIATE_TEST_SUITE_P(ShouldersApart, PlanarFiveBar, ::testing::Values(0.0, 0.04),
                         [](const auto& test) { return test.param == 0 ? "not" : "by_40_mm"; });

TEST_P(PlanarFiveBar, PutsTheFootOnTargetsInItsPlane) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x(-0.1, 0.1), z(-0.27, -0.12);
  for (const Leg leg : kLegs) {
    const LegKinematics kinematics = make_leg_kinematics(*robot_, leg);
    ASSERT_EQ(kinematics.servo_count(), 2);
    ASSERT_EQ(kinematics.passive_count(), 2);
    EXPECT_EQ(kinematics.home_branch().mode, WorkingMode::kDownUp);
    for (int i = 0; i < 200; ++i) {
      const Vector3 target(x(random), 0, z(random));
      const LegInverse inverse = kinematics.inverse(target);
      ASSERT_EQ(inverse.status, IkStatus::kOk) << target.transpose();
      EXPECT_LT((foot_at(leg, kinematics, inverse.posture) - target).norm(), 1e-12);
      const LegForward forward = kinematics.forward(inverse.posture.servos);
      EXPECT_TRUE(forward.closed);
      EXPECT_LT((forward.foot - target).norm(), 1e-12);
      EXPECT_LT((forward.passive - inverse.posture.passive).norm(), 1e-9);
    }
  }
}

TEST_P(PlanarFiveBar, SaysThatItCannotTurnAside) {
  const LegKinematics kinematics = make_leg_kinematics(*robot_, Leg::FL);
  const LegInverse aside = kinematics.inverse({0.02, 0.03, -0.2});
  EXPECT_EQ(aside.status, IkStatus::kClampedTooFar);
  const LegInverse below = kinematics.inverse({0.02, 0, -0.2});
  EXPECT_EQ(aside.posture.servos, below.posture.servos);
}

TEST_P(PlanarFiveBar, StaysFiniteWhereverItIsSent) {
  const LegKinematics kinematics = make_leg_kinematics(*robot_, Leg::RR);
  const double nan = std::nan("");
  for (const Vector3& target : {Vector3(0, 0, -5), Vector3(3, 0, -0.1), Vector3(-2, 0, 4),
                                Vector3::Zero().eval(), Vector3(0, 0, -0.3), Vector3(nan, 0, 0)}) {
    const LegInverse inverse = kinematics.inverse(target);
    EXPECT_TRUE(inverse.posture.servos.allFinite() && inverse.posture.passive.allFinite())
        << target.transpose();
    if (inverse.status == IkStatus::kOk || !target.allFinite()) continue;
    // It reaches as far as both chains let it.
    const LegForward there = kinematics.forward(inverse.posture.servos);
    EXPECT_TRUE(there.foot.allFinite());
  }
  const LegInverse far = kinematics.inverse({0, 0, -5});
  EXPECT_EQ(far.status, IkStatus::kClampedTooFar);
  // By the angles: stretched on one axis its elbows are one point, about which the foot could be anywhere.
  EXPECT_NEAR(foot_at(Leg::RR, kinematics, far.posture).z(), -std::sqrt(0.09 - GetParam() * GetParam() / 4),
              1e-6);
}

TEST_P(PlanarFiveBar, JacobianIsTheDerivative) {
  const LegKinematics kinematics = make_leg_kinematics(*robot_, Leg::FR);
  constexpr double kSmall = 1e-6;
  for (const Vector3& target : {Vector3(0.03, 0, -0.2), Vector3(-0.05, 0, -0.24), Vector3(0, 0, -0.15)}) {
    const LegPosture posture = kinematics.inverse(target).posture;
    const LegJacobian J = kinematics.jacobian(posture);
    ASSERT_EQ(J.cols(), 2);
    for (int k = 0; k < 2; ++k) {
      ServoVector up = posture.servos, down = posture.servos;
      up[k] += kSmall, down[k] -= kSmall;
      const Vector3 slope = (kinematics.forward(up).foot - kinematics.forward(down).foot) / (2 * kSmall);
      EXPECT_LT((slope - J.col(k)).norm(), 1e-8) << k;  // of central differences of 1e-6 rad
    }
  }
}

TEST(FiveBarHome, SaysWhichWayTheElbowsBend) {
  RobotDescription robot = *scenes::planar_five_bars(0.04);
  for (const WorkingMode mode :
       {WorkingMode::kDownUp, WorkingMode::kUpDown, WorkingMode::kBothUp, WorkingMode::kBothDown}) {
    const LegKinematics before = make_leg_kinematics(robot, Leg::FL);
    const LegPosture posture = before.inverse({0, 0, -0.22}, {.mode = mode}).posture;
    const LegModel& model = (*robot.legs)[Leg::FL];
    for (int i = 0; i < 2; ++i) {
      robot.home[model.servos[static_cast<std::size_t>(i)]] = posture.servos[i];
      robot.home[model.passive[static_cast<std::size_t>(i)]] = posture.passive[i];
    }
    EXPECT_EQ(make_leg_kinematics(robot, Leg::FL).home_branch().mode, mode);
  }
}

}  // namespace
}  // namespace crossgait
