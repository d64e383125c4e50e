// Every check that can be asked of the engine in plain code, which others begin with, holds; and few cannot.
#include <cstdlib>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/conformance_check.h"

namespace crossgait::conformance {
namespace {

const std::string kEngine = "skeleton";

// Before anything asks for engines: the registry looks once.
const bool kAlongside = setenv("CROSSGAIT_ENGINE_PATH", CROSSGAIT_SKELETON_FOLDER, 1) == 0;

class SkeletonEngine : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(EveryCheck, SkeletonEngine, ::testing::ValuesIn(names_of_checks()),
                         [](const auto& test) { return test.param; });

TEST_P(SkeletonEngine, Holds) { expect_holds(GetParam(), kEngine); }

// It says of itself what it can, so nothing else is left out.
TEST(SkeletonEngine, IsAskedNearlyEverything) {
  ASSERT_TRUE(kAlongside);
  const Subject subject = subject_of(kEngine);
  std::set<std::string> left_out;
  for (const Check& check : checks())
    if (check.precondition.is_met != nullptr && !check.precondition.is_met(subject))
      left_out.insert(check.name);
  EXPECT_EQ(left_out, (std::set<std::string>{"soft_friction",
                                             "turning_friction",
                                             "error_reduction",
                                             "joint_limit_rest",
                                             "implicit_servo_recursion",
                                             "implicit_servo_stiff",
                                             "implicit_servo_friction",
                                             "implicit_servo_limits",
                                             "implicit_servo_standing",
                                             "same_implicit_servos",
                                             "joint_limit_stop",
                                             "joint_limit_return",
                                             "joint_limit_none",
                                             "joint_limits_reported",
                                             "same_swing",
                                             "same_trot_flat",
                                             "same_trot_rough",
                                             "same_sled",
                                             "same_joint_friction",
                                             "same_couplings"}));
}

}  // namespace
}  // namespace crossgait::conformance
