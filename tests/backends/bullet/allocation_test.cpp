// Native Bullet allocates inside its own narrowphase and solver, through its own allocator. What goes through
// that is the engine's and not counted here: nothing else allocates.
#include <cstdlib>

#include <LinearMath/btAlignedAllocator.h>
#include <gtest/gtest.h>

#include "backends/bullet/bullet_backend.h"
#include "tests/support/allocations.h"

namespace crossgait::bullet {
namespace {

void* allocate(std::size_t size) {
  const AllocationPause pause;
  return std::malloc(size);
}

// Before main: no memory of Bullet's comes from another allocator than the one it goes back to.
[[maybe_unused]] const bool kInstalled = [] {
  btAlignedAllocSetCustom(allocate, std::free);
  return true;
}();

TEST(NativeAllocation, NoneOfCrossgaitsOwnPerStep) {
  for (const Engine& engine : {native_engine(), own_engine()}) {
    EXPECT_EQ(allocations_of_a_trot(engine, Terrain()), 0U);
    EXPECT_EQ(allocations_of_a_trot(engine, make_terrain("rough", 2)), 0U);
    EXPECT_EQ(
        allocations_of_a_trot(engine, Terrain(), scenes::with_joint_friction(scenes::quadruped(), 0.02)), 0U);
    EXPECT_EQ(allocations_of_pushes_and_refused_targets(engine), 0U);
    EXPECT_EQ(allocations_of_a_crowd_of_contacts(engine, 300), 0U);
  }
}

TEST(NativeAllocation, NoneOfCrossgaitsOwnPerStepOfAnEnvironment) {
  EXPECT_EQ(allocations_of_an_environment(native_engine()), 0U);
  EXPECT_EQ(allocations_of_a_batch(native_engine()), 0U);
}

TEST(NativeAllocation, NoneOfCrossgaitsOwnInTheClosedLoop) {
  EXPECT_EQ(allocations_of_a_gait(native_engine()), 0U);
  EXPECT_EQ(allocations_of_the_gait_by_speed(native_engine()), 0U);
  EXPECT_EQ(allocations_of_standing_feet(native_engine()), 0U);
}

TEST(NativeAllocation, IsDeclaredForAllThatContainsBulletsOwnCode) {
  for (const char* name : {"bullet", "bullet-sweeps", "bullet:matched+narrowphase"}) {
    EXPECT_TRUE(find(name)->info.capabilities.allocates) << name;
  }
  for (const char* name : {"bullet:matched", "bullet:matched+surface"}) {
    EXPECT_FALSE(find(name)->info.capabilities.allocates) << name;
  }
}

}  // namespace
}  // namespace crossgait::bullet
