// Numbers that tests of every folder need.
#pragma once

#include <limits>

namespace crossgait::test {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace crossgait::test
