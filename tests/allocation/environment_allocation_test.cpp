// No allocation per policy step, in one environment or many.
#include "tests/support/allocations.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

class EnvironmentAllocation : public EngineTest {
 protected:
  void SetUp() override {
    if (capabilities().allocates) GTEST_SKIP() << "the engine's own library allocates";
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(EnvironmentAllocation);

TEST_P(EnvironmentAllocation, NonePerStep) {
  EXPECT_EQ(allocations_of_an_environment(find_engine(GetParam())), 0U);
  EXPECT_EQ(allocations_of_an_environment(find_engine(GetParam()), full_joint_environment()), 0U);
}

TEST_P(EnvironmentAllocation, NonePerStepOfABatch) {
  EXPECT_EQ(allocations_of_a_batch(find_engine(GetParam())), 0U);
}

}  // namespace
}  // namespace crossgait
