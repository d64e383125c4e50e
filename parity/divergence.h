// How far two runs of the same controller lie apart, and what went first.
#pragma once

#include <optional>
#include <string>

#include "crossgait/parity/trace.h"

namespace crossgait {

/// Bounds within which two runs count as the same.
struct DivergenceTolerances {
  double position = 1e-3;  ///< of the base, m
  double joint = 1e-2;     ///< largest difference of a joint angle, rad
  double attitude = 1e-2;  ///< angle between the base orientations, rad

  /// For engines that declare the same contact law: rounding with room (a 5 s trot differs by about 1e-14 m).
  static DivergenceTolerances exact() { return {1e-6, 1e-6, 1e-6}; }
};

/// The first time one quantity left its tolerance.
struct FirstDivergence {
  std::string quantity;  ///< "position", "joint" or "attitude"
  double time_s = 0;
  double tolerance = 0;  ///< m or rad
};

struct PairDifference {
  std::string a, b;  ///< backend names
  double max_position_difference_m = 0;
  double max_joint_difference_rad = 0;
  double max_attitude_difference_rad = 0;
  DivergenceTolerances tolerances;
  std::optional<FirstDivergence> first_divergence;  ///< earliest of the three; empty if all stayed within
};

/// Angle of the rotation between two orientations, in [0, pi], rad. Accurate near zero.
double attitude_difference(const Quaternion& a, const Quaternion& b) noexcept;

/// Compares sample by sample over the time both runs cover.
PairDifference compare_traces(const Trace& a, const Trace& b, const DivergenceTolerances& tolerances);

}  // namespace crossgait
