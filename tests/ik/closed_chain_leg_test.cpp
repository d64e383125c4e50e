// Legs of which loops move a joint: the foot where the robot has it, and back; a four-bar against its closed
// form.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "ik/leg_kinematics.h"
#include "physics/core/error.h"
#include "physics/robot/multibody.h"
#include "scenes/scenes.h"
#include "tests/ik/serial_robot.h"

namespace crossgait {
namespace {

using test::uniform;

class ClosedChains : public ::testing::TestWithParam<scenes::RobotPtr (*)()> {
 protected:
  const scenes::RobotPtr robot_ = GetParam()();

  /// The foot in the leg frame, by the robot's own tree; what joins the loop has to be in one place.
  Vector3 foot_at(Leg leg, const LegKinematics& kinematics, const ServoVector& servos,
                  const PassiveVector& passive) const {
    RobotState state;
    state.q = robot_->home;
    for (int i = 0; i < kinematics.servo_count(); ++i)
      state.q[kinematics.servo_joints()[static_cast<std::size_t>(i)]] = servos[i];
    for (int i = 0; i < kinematics.passive_count(); ++i)
      state.q[kinematics.passive_joints()[static_cast<std::size_t>(i)]] = passive[i];
    std::vector<Pose> poses;
    forward_kinematics(*robot_, state, poses);
    EXPECT_LT(max_loop_gap(*robot_, poses), 1e-11);
    return foot_position(*robot_, leg, poses) - kinematics.origin();
  }
};
INSTANTIATE_TEST_SUITE_P(, ClosedChains, ::testing::Values(&scenes::four_bar_knees, &scenes::pantographs),
                         [](const auto& test) { return test.param()->name; });

TEST_P(ClosedChains, PutTheFootWhereTheRobotDoes) {
  std::mt19937 random(1);
  for (const Leg leg : kLegs) {
    const LegKinematics kinematics = make_leg_kinematics(*robot_, leg);
    ASSERT_EQ(kinematics.kind(), LegKind::kClosedChain);
    ASSERT_EQ(kinematics.servo_count(), 3);
    ASSERT_EQ(kinematics.passive_count(), 2);
    for (int i = 0; i < 200; ++i) {
      const ServoVector servos{
          {uniform(random, -0.4, 0.4), uniform(random, -0.4, 0.4), uniform(random, -0.4, 0.4)}};
      const LegForward forward = kinematics.forward(servos);
      ASSERT_TRUE(forward.closed);
      EXPECT_LT((foot_at(leg, kinematics, servos, forward.passive) - forward.foot).norm(), 1e-14);
    }
  }
}

TEST_P(ClosedChains, PutTheFootOnTargets) {
  std::mt19937 random(2);
  for (const Leg leg : kLegs) {
    const LegKinematics kinematics = make_leg_kinematics(*robot_, leg);
    EXPECT_LT(kinematics.inverse({0, 0, -0.2}).posture.servos.norm(), 1e-9) << "which is home";
    for (int i = 0; i < 200; ++i) {
      const Vector3 target(uniform(random, -0.05, 0.05), uniform(random, -0.05, 0.05),
                           uniform(random, -0.215, -0.16));
      const LegInverse inverse = kinematics.inverse(target);
      ASSERT_EQ(inverse.status, IkStatus::kOk) << target.transpose();
      EXPECT_LT((foot_at(leg, kinematics, inverse.posture.servos, inverse.posture.passive) - target).norm(),
                2 * kConverged);
      const LegForward forward = kinematics.forward(inverse.posture.servos);
      EXPECT_LT((forward.passive - inverse.posture.passive).norm(), 1e-9) << "another way to the same angles";
    }
  }
}

TEST_P(ClosedChains, HaveTheDerivativeAsJacobian) {
  std::mt19937 random(3);
  constexpr double kStep = 1e-5;
  const LegKinematics kinematics = make_leg_kinematics(*robot_, Leg::RR);
  for (int i = 0; i < 100; ++i) {
    const ServoVector servos{
        {uniform(random, -0.3, 0.3), uniform(random, -0.3, 0.3), uniform(random, -0.3, 0.3)}};
    const LegJacobian J = kinematics.jacobian({servos, kinematics.forward(servos).passive});
    for (int k = 0; k < 3; ++k) {
      ServoVector more = servos, less = servos;
      more[k] += kStep;
      less[k] -= kStep;
      // Third derivatives are larger next to a dead point: 1e-8 allows for 600 m.
      const Vector3 column = (kinematics.forward(more).foot - kinematics.forward(less).foot) / (2 * kStep);
      ASSERT_LT((J.col(k) - column).norm(), 1e-8) << k;
    }
  }
}

TEST_P(ClosedChains, StopAtLimitsAndSaySo) {
  const LegKinematics kinematics = make_leg_kinematics(*robot_, Leg::FL);
  const LegInverse far = kinematics.inverse({0.1, 0, -0.5});
  EXPECT_NE(far.status, IkStatus::kOk);
  EXPECT_TRUE(far.posture.servos.allFinite() && far.posture.passive.allFinite());
  EXPECT_LE(far.posture.servos.cwiseAbs().maxCoeff(), 1.2);
  EXPECT_LE(far.posture.passive.cwiseAbs().maxCoeff(), 1.2 + 1e-9);
  const LegInverse none = kinematics.inverse({0, std::nan(""), -0.2});
  EXPECT_EQ(none.status, IkStatus::kInvalidTarget);
  EXPECT_TRUE(none.posture.servos.allFinite());
  ServoVector wild(3);
  wild << 0, 1e9, -1e9;
  EXPECT_TRUE(kinematics.forward(wild).foot.allFinite());
}

// Of a four-bar the knee's angle is in closed form: the rod's end is on two circles, about the crank's tip
// and about the knee.
TEST(FourBarKnee, TurnsAsItsClosedFormSays) {
  const scenes::RobotPtr robot = scenes::four_bar_knees();
  const LegKinematics kinematics = make_leg_kinematics(*robot, Leg::FL);
  const Vector2 knee(-0.07, -0.1), tip(-0.03, 0.02), end(-0.095, -0.07);
  const auto turned = [](const Vector2& v, double angle) {  // about +y: x towards -z
    return Vector2(std::cos(angle) * v.x() + std::sin(angle) * v.y(),
                   -std::sin(angle) * v.x() + std::cos(angle) * v.y());
  };
  const double rod = (end - tip).norm(), lever = (end - knee).norm();
  std::mt19937 random(4);
  for (int i = 0; i < 200; ++i) {
    const double hip = uniform(random, -0.4, 0.4), crank = uniform(random, -0.4, 0.4);
    const Vector2 K = turned(knee, hip), T = turned(tip, crank);
    const double base = (T - K).norm();
    const double opened = std::acos((lever * lever + base * base - rod * rod) / (2 * lever * base));
    // Angles counted as those of joints: from x towards -z.
    const auto angle_of = [](const Vector2& v) { return std::atan2(-v.y(), v.x()); };
    const auto nearest = [&](double sign) {
      return std::remainder(angle_of(T - K) + sign * opened, 2 * M_PI);
    };
    const double at_zero = angle_of(end - knee);
    const auto knee_angle = [&](double sign) {
      return std::remainder(nearest(sign) - at_zero - hip, 2 * M_PI);
    };
    const double sign =
        std::abs(std::remainder(angle_of(tip - knee) +
                                    std::acos((lever * lever + (tip - knee).squaredNorm() - rod * rod) /
                                              (2 * lever * (tip - knee).norm())) -
                                    at_zero,
                                2 * M_PI)) < 1e-9
            ? 1
            : -1;
    const LegForward forward = kinematics.forward(ServoVector{{0.2, hip, crank}});
    ASSERT_TRUE(forward.closed);
    // Loops are closed to 1e-12 m, on a lever of 0.04 m.
    EXPECT_NEAR(forward.passive[0], knee_angle(sign), 1e-10) << hip << ", " << crank;
    // The margin to where the rod cannot drive the knee is the angle between rod and lever.
    const Vector2 P = K + turned(end - knee, hip + forward.passive[0]);
    const Vector2 along_rod = P - T, along_lever = P - K;
    const double between =
        std::acos(std::abs(along_rod.dot(along_lever)) / (along_rod.norm() * along_lever.norm()));
    const LegMargins margins = kinematics.margins({ServoVector{{0.2, hip, crank}}, forward.passive});
    EXPECT_NEAR(margins.parallel, between, 1e-9);
  }
}

TEST(ClosedChain, RefusesABarThatNothingHolds) {
  RobotDescription robot = *scenes::four_bar_knees();
  robot.loops.erase(robot.loops.begin());
  EXPECT_THROW(make_leg_kinematics(robot, Leg::FL), ConfigError);
  EXPECT_NO_THROW(make_leg_kinematics(robot, Leg::FR));
}

}  // namespace
}  // namespace crossgait
