// No allocation in the kinematics of any kind of leg, reached or not.
#include <gtest/gtest.h>

#include "ik/leg_kinematics.h"
#include "scenes/scenes.h"
#include "tests/ik/serial_robot.h"
#include "tests/support/allocation_counter.h"

namespace crossgait {
namespace {

LegKinematics serial_kinematics(bool has_abduction, const Vector3& knee_axis) {
  test::LegAtZero leg;
  leg.has_abduction = has_abduction;
  leg.knee_axis = knee_axis;
  test::SerialRobot made = test::serial_robot(leg);
  made.robot.home = JointVector::Zero(made.joint_count());
  made.robot.home[made.joints.hip] = 0.7;
  made.robot.home[made.joints.knee] = -1.4;
  return make_leg_kinematics(made.robot, leg.leg, made.joints);
}

TEST(LegKinematicsAllocation, NoneOfAnyKind) {
  const Vector3 oblique = Vector3(0.1, 1, 0).normalized();
  const std::vector<LegKinematics> legs{make_leg_kinematics(*scenes::quadruped(), Leg::FL),
                                        make_leg_kinematics(*scenes::four_bar_knees(), Leg::FL),
                                        make_leg_kinematics(*scenes::pantographs(), Leg::FL),
                                        serial_kinematics(true, Vector3::UnitY()),
                                        serial_kinematics(false, Vector3::UnitY()),
                                        serial_kinematics(true, oblique),
                                        serial_kinematics(false, oblique)};
  double sum = 0;
  const AllocationScope scope;
  for (const LegKinematics& original : legs) {
    // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): a copy is free, too
    const LegKinematics leg = original;
    for (const Vector3& target : {Vector3(0.01, 0.01, -0.07), Vector3(0.05, 0, -0.3), Vector3(1, 1, -1)}) {
      for (const KneeBranch knee : {KneeBranch::kForward, KneeBranch::kBackward}) {
        const LegInverse inverse = leg.inverse(target, {.knee = knee});
        sum += leg.forward(inverse.posture.servos).foot.sum() + leg.jacobian(inverse.posture).sum() +
               leg.margins(inverse.posture).serial;
      }
    }
  }
  EXPECT_EQ(scope.count(), 0U);
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace crossgait
