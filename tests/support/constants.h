// Numbers that tests of every folder need.
#pragma once

#include <limits>

namespace crossgait::test {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kGravity = 9.81;  ///< m/s^2, of worlds that say nothing else

}  // namespace crossgait::test
