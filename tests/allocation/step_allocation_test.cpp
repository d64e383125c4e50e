// No allocation per step once the first steps have sized every buffer. Engines whose own library allocates
// say so; what remains to be shown of them needs a look inside (tests/backends/bullet/allocation_test.cpp).
#include <gtest/gtest.h>

#include "motion/foot_target_tracker.h"
#include "motion/gait_source.h"
#include "tests/support/allocations.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

class StepAllocation : public EngineTest {
 protected:
  void SetUp() override {
    if (capabilities().allocates) GTEST_SKIP() << "the engine's own library allocates";
  }
  Engine engine() const { return find_engine(GetParam()); }
};
CROSSGAIT_FOR_EVERY_BACKEND(StepAllocation);

TEST_P(StepAllocation, NoneOnFlatGround) { EXPECT_EQ(allocations_of_a_trot(engine(), Terrain()), 0U); }

TEST_P(StepAllocation, NoneOnRoughGround) {
  EXPECT_EQ(allocations_of_a_trot(engine(), make_terrain("rough", 2)), 0U);
}

TEST_P(StepAllocation, NoneForShapesOfEveryKind) {
  EXPECT_EQ(allocations_of_a_fall(engine(), Terrain()), 0U);
  EXPECT_EQ(allocations_of_a_fall(engine(), make_terrain("rough:flat_radius=0", 2)), 0U);
}

TEST_P(StepAllocation, NoneForManyContacts) { EXPECT_EQ(allocations_of_a_crowd_of_contacts(engine()), 0U); }

TEST_P(StepAllocation, NoneForJointFriction) {
  const scenes::RobotPtr robot = scenes::with_joint_friction(scenes::quadruped(), 0.02);
  EXPECT_EQ(allocations_of_a_trot(engine(), make_terrain("rough", 2), robot), 0U);
}

TEST_P(StepAllocation, NoneForImplicitServos) {
  const Engine used = engine();
  if (used.info.laws.implicit_servos.empty()) GTEST_SKIP() << "no Laws::implicit_servos";
  const scenes::RobotPtr robot = scenes::with_implicit_servos(scenes::quadruped());
  EXPECT_EQ(allocations_of_a_trot(used, make_terrain("rough", 2), robot), 0U);
}

TEST_P(StepAllocation, NoneForPushesAndRefusedTargets) {
  EXPECT_EQ(allocations_of_pushes_and_refused_targets(engine()), 0U);
}

class DeclaredAllocation : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(DeclaredAllocation);

// An engine may not skip the tests above by saying that it allocates where it does not.
TEST_P(DeclaredAllocation, IsTrue) {
  if (!capabilities().allocates) GTEST_SKIP() << "shown by the tests above";
  const Engine engine = find_engine(GetParam());
  EXPECT_GT(allocations_of_a_trot(engine, Terrain()) + allocations_of_pushes_and_refused_targets(engine), 0U);
}

TEST(ControlAllocation, NoneInGaitKinematicsAndCompensation) {
  const auto robot = scenes::quadruped();
  FootTargetTracker legs(robot);
  GaitGenerator gait(find_gait("trot"), find_gait("trot").preferred, leg_origins(*robot));
  const AllocationScope scope;
  for (int i = 0; i < 1000; ++i) {
    LegArray<Vector3> feet;
    const LegArray<FootTarget>& targets = gait.update(2e-3);
    for (const Leg leg : kLegs) feet[leg] = targets[leg].position;
    (void)legs.update(feet, 2e-3);
  }
  EXPECT_EQ(scope.count(), 0U);
}

}  // namespace
}  // namespace crossgait
