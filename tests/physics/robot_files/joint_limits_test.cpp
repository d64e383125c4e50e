#include "physics/robot_files/joint_limits.h"

#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace crossgait {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

struct Limited {
  Joint joint;
  std::vector<std::string> warnings;
};

Limited limited(double lower, double upper, bool follows = false) {
  Limited result;
  ReaderWarnings warnings;
  set_limits(lower, upper, follows, "joint 'a'", result.joint, warnings);
  result.warnings = warnings.sentences();
  return result;
}

TEST(JointLimits, SayWhichOneIsNotGiven) {
  const Limited below = limited(-1, kInfinite), above = limited(-kInfinite, 1);
  EXPECT_EQ(below.joint.lower, -1);
  EXPECT_EQ(below.joint.upper, std::numbers::pi);
  EXPECT_EQ(above.joint.lower, -std::numbers::pi);
  EXPECT_TRUE(below.joint.limited);
  const std::vector<std::string> said{
      "took +-pi rad for the one limit that is not given in 1 joint(s), first in joint 'a'"};
  EXPECT_EQ(below.warnings, said);
  EXPECT_EQ(above.warnings, said);
  EXPECT_EQ(limited(-1, 40).warnings.size(), 1U);
  EXPECT_NE(limited(-1, 40).warnings[0].find("beyond +-2 pi rad, likely degrees"), std::string::npos);
}

TEST(JointLimits, OfFollowersMayBeOfManyTurns) {
  const Limited geared = limited(-100, 90, true);
  EXPECT_EQ(geared.joint.lower, -100);
  EXPECT_EQ(geared.joint.upper, 90);
  EXPECT_TRUE(geared.joint.limited);
  EXPECT_TRUE(geared.warnings.empty());
  for (const auto& [lower, upper] : {std::pair(-1e9, 1e9), {0.0, 0.0}}) {
    EXPECT_FALSE(limited(lower, upper, true).joint.limited);
    EXPECT_EQ(limited(lower, upper, true).warnings.size(), 1U);
  }
}

}  // namespace
}  // namespace crossgait
