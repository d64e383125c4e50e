// What rows of single joints may do, and how many there are.
#pragma once

#include <limits>

#include "physics/core/math.h"

namespace crossgait::contact {

/// Bounds the impulse of a constraint row, N m s: dry friction's on either side, of a limit one is 0 and the
/// other infinite. 0 lies within them.
struct ImpulseBounds {
  double lower, upper;
};
inline constexpr ImpulseBounds kOnlyPushes{0, std::numeric_limits<double>::infinity()};

/// Number of rows: dry friction of each joint, the limit that is nearer, and an implicit servo.
inline constexpr int kMaxBoundedRows = 3 * kMaxJoints;

}  // namespace crossgait::contact
