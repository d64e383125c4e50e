// No allocation in the closed loop, whatever drives it. Engines whose own library allocates are counted in
// their own folder's tests.
#include <gtest/gtest.h>

#include "tests/support/allocations.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

class ClosedLoopAllocation : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(ClosedLoopAllocation);

TEST_P(ClosedLoopAllocation, NonePerStepWhateverDrivesIt) {
  if (capabilities().allocates) GTEST_SKIP() << "the engine's own library allocates";
  EXPECT_EQ(allocations_of_a_gait(find_engine(GetParam())), 0U);
  EXPECT_EQ(allocations_of_the_gait_by_speed(find_engine(GetParam())), 0U);
  EXPECT_EQ(allocations_of_standing_feet(find_engine(GetParam())), 0U);
}

}  // namespace
}  // namespace crossgait
