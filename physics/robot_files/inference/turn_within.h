// Angles that mean the same, and the one that a joint may have. Private to inference.
#pragma once

#include <cmath>
#include <optional>

#include "physics/robot/robot.h"

namespace crossgait {

/// Returns the turn of `angle` (rad) that lies within a joint's limits, if there is one.
inline std::optional<double> turn_within(double angle, const Joint& joint) {
  for (const double turned : {angle, angle - 2 * M_PI, angle + 2 * M_PI}) {
    if (turned >= joint.lower && turned <= joint.upper) return turned;
  }
  return std::nullopt;
}

}  // namespace crossgait
