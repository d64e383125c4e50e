// What a robot's size makes of gaits: lengths go with its standing height h, times with sqrt(h / g), speeds
// with sqrt(g h) (Froude; Alexander, The gaits of bipedal and quadrupedal animals, 1984).
#pragma once

#include <cmath>

#include "gait/multi_gait_controller.h"
#include "physics/robot/robot.h"

namespace crossgait {

/// The standing height that the numbers of `gaits()`, of the parameter table and of every default are for, m.
inline constexpr double kReferenceHeight = 0.062;

struct GaitScale {
  double length = 1;         ///< standing height in reference heights
  double stance_offset = 0;  ///< of the robot, m
  /// Serial legs have gaits of their own: `Gait::preferred_serial`.
  LegLinkage linkage = LegLinkage::kFiveBar;

  double time() const noexcept { return std::sqrt(length); }  ///< and of speeds
};

/// Compares a robot with the reference; one without a standing height has the reference's scale.
GaitScale gait_scale(const RobotDescription& robot) noexcept;

/// Scales lengths by `length` and times by `time()`.
GaitParameters scaled(const GaitParameters& parameters, const GaitScale& scale) noexcept;
/// Returns the gait with the preferred parameters that a robot of this size and these legs walks with.
Gait scaled(const Gait& gait, const GaitScale& scale) noexcept;
StepLimits scaled(const StepLimits& limits, const GaitScale& scale) noexcept;
/// Scales bands, hysteresis, steps and cycles; the gaits of the bands as above.
MultiGaitOptions scaled(MultiGaitOptions options, const GaitScale& scale);
/// Scales the table's ranges and delta scales to this size; what `ranges` states itself stays.
AdaptationRanges scaled(AdaptationRanges ranges, const GaitScale& scale);

}  // namespace crossgait
