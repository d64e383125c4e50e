// No allocation per step once the first steps have sized every buffer. MuJoCo and the matched mode make none
// at all; Bullet's own narrowphase and solver do, through Bullet's allocator (bullet/bullet_allocator.cpp),
// which is not counted.
#include <gtest/gtest.h>

#include "crossgait/env/gait_source.h"
#include "crossgait/env/leg_controller.h"
#include "crossgait/tests/support/allocation_counter.h"
#include "crossgait/tests/support/backend_test.h"

namespace crossgait {
namespace {

class StepAllocation : public BackendTest {};
CROSSGAIT_FOR_EVERY_BACKEND(StepAllocation);

std::size_t allocations_of_a_trot(PhysicsBackend& backend) {
  const scenes::Trot trot(backend.robot());
  int i = 0;
  const auto steps = [&](int count) {
    for (const int end = i + count; i < end; ++i) {
      EXPECT_EQ(backend.step(trot.targets(i * 1e-3)), StepStatus::kOk);
      (void)backend.foot_contacts();
    }
  };
  steps(1500);  // a stand and more than a cycle: every buffer has had its largest size
  const AllocationScope scope;
  steps(1600);
  return scope.count();
}

TEST_P(StepAllocation, NoneOnFlatGround) {
  const auto backend = make(scenes::quadruped());
  EXPECT_EQ(allocations_of_a_trot(*backend), 0U);
}

TEST_P(StepAllocation, NoneOnRoughGround) {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  spec.terrain = make_terrain("rough", 2);
  const auto backend = make(spec);
  EXPECT_EQ(allocations_of_a_trot(*backend), 0U);
}

TEST_P(StepAllocation, NoneForPushesAndRefusedTargets) {
  const auto backend = make(scenes::quadruped());
  const JointTargets targets = scenes::home_targets(backend->robot());
  ASSERT_EQ(backend->step(targets, 500), StepStatus::kOk);
  const AllocationScope scope;
  backend->apply_push({0.01, 0, 0});
  EXPECT_EQ(backend->step(targets, 10), StepStatus::kOk);
  EXPECT_EQ(backend->step({}), StepStatus::kInvalidTargets);
  EXPECT_EQ(scope.count(), 0U);
}

TEST(ControlAllocation, NoneInGaitKinematicsAndCompensation) {
  const auto robot = scenes::quadruped();
  LegController legs(robot);
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
