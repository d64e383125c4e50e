// No allocation in the closed loop, whatever drives it.
#include <gtest/gtest.h>

#include "crossgait/env/closed_loop.h"
#include "crossgait/env/gait_source.h"
#include "crossgait/tests/support/allocation_counter.h"
#include "crossgait/tests/support/backend_test.h"

namespace crossgait {
namespace {

class ClosedLoopAllocation : public BackendTest {
 protected:
  static std::size_t allocations_of(const WorldSpec& spec, const TargetSource& source) {
    const auto world = make(spec);
    ClosedLoop loop(*spec.robot, {});
    Randomisation randomisation;
    randomisation[Randomised::kPushImpulse] = {0.001, 0.005};
    randomisation[Randomised::kPushInterval] = {0.1, 0.2};
    Random random(1);
    loop.start(*world, source, {{}, 0, Pushes(randomisation, draw(randomisation, random), random)});
    loop.advance(*world, source, 750);  // every buffer has had its largest size
    const AllocationScope scope;
    EXPECT_TRUE(loop.advance(*world, source, 750));
    EXPECT_GT(loop.statistics().summary(*world).physics_steps, 0);
    return scope.count();
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(ClosedLoopAllocation);

TEST_P(ClosedLoopAllocation, NonePerStepWhateverDrivesIt) {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  spec.terrain = make_terrain("rough", 2);
  EXPECT_EQ(allocations_of(spec, make_gait_source(choose_gait("trot", {}), spec.robot)), 0U);
  EXPECT_EQ(allocations_of(
                spec, make_gait_source(choose_gait("auto", {}, VelocityCommand{0.1, 0, 0.1}), spec.robot)),
            0U);
  LegArray<Vector3> feet;
  feet.fill(Vector3(0, 0, -0.06));
  EXPECT_EQ(allocations_of(spec, make_feet_source([feet](double) { return feet; }, spec.robot)), 0U);
}

}  // namespace
}  // namespace crossgait
