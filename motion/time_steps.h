// Steps that are made of shorter ones: physics in control, control in policy.
#pragma once

#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {

/// Counts steps of `shorter` in `longer` seconds, to the nearest.
inline int step_count(double longer, double shorter) noexcept {
  return static_cast<int>(std::lround(longer / shorter));
}

/// Tells if `longer` is one or more whole times `shorter`, but for the rounding of times as decimals.
inline bool is_whole_multiple(double longer, double shorter) noexcept {
  const double ratio = longer / shorter;
  return std::isfinite(ratio) && ratio > 0.5 && std::abs(ratio - std::round(ratio)) < 1e-9 * ratio;
}

/// Returns how many steps of `shorter` make `longer`. @throws ConfigError naming `element` unless it is a
/// whole number
inline int whole_steps(std::string_view element, double longer, double shorter) {
  if (!is_whole_multiple(longer, shorter)) {
    throw ConfigError("timing", element, fmt::format("a whole multiple of {:g} s", shorter),
                      fmt::format("{:g} s", longer));
  }
  return step_count(longer, shorter);
}

}  // namespace crossgait
