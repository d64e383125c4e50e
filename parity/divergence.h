// How far two runs of the same controller lie apart, and what went first.
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "motion/trace.h"
#include "parity/growth.h"
#include "parity/parting.h"

namespace crossgait {

/// Bounds how far two runs that count as the same may differ.
struct DivergenceTolerances {
  double position = 1e-3;  ///< of the base, m
  double joint = 1e-2;     ///< largest difference of a joint angle, rad
  double attitude = 1e-2;  ///< angle between the base orientations, rad
  /// Bounds the force on a foot, N, and a joint's torque, N m. Not watched unless asked for: both jump at
  /// every touchdown that comes a step earlier.
  double load = std::numeric_limits<double>::infinity();
  double torque = std::numeric_limits<double>::infinity();

  /// Returns tolerances of one contact law: rounding with room (a 5 s trot differs by about 1e-14 m).
  static DivergenceTolerances exact() { return {.position = 1e-6, .joint = 1e-6, .attitude = 1e-6}; }
  /// Returns those of engines of which one rounds so: of float32 a thousand epsilons, since a trot differs by
  /// 1e-7 m until a foot lands a step earlier.
  static DivergenceTolerances exact(Precision precision) {
    if (precision == Precision::kFloat64) return exact();
    return {.position = 1e-4, .joint = 1e-4, .attitude = 1e-4};
  }

  /// Returns tolerances for the first sign of a known change: about 1e-4 of the size of each (legs of a tenth
  /// of a metre, angles of a radian, a weight of several N, torques of a tenth N m).
  static DivergenceTolerances fine() {
    return {.position = 1e-5, .joint = 1e-4, .attitude = 1e-4, .load = 1e-3, .torque = 1e-5};
  }
};

/// Describes the first time one quantity left its tolerance.
struct FirstDivergence {
  std::string quantity;  ///< "position", "joint", "attitude", "load" or "torque"
  double time_s = 0;
  double tolerance = 0;  ///< in the quantity's unit
  /// What the differences of single steps from the same state alone come to by then, each of them going on as
  /// a speed, m or rad; empty where steps were not compared, or the first that was recorded was not alike.
  /// What is more is chaos.
  std::optional<double> carried = {};
};

/// Holds how far two engines lie apart after one control step from the same state with the same targets, at
/// most (one_step.h).
struct OneStepDifference {
  double position_m = 0, joint_rad = 0, attitude_rad = 0;
  double at_s = 0;  ///< where the largest of the three is, simulated time
  int steps = 0;    ///< control steps that were made so

  /// Returns the largest difference, m or rad.
  double largest() const noexcept;
};

struct PairDifference {
  std::string a, b;        ///< names of engines
  bool same_laws = false;  ///< both engines solve the same equations, so that they are held to `exact()`
  Precision precision = Precision::kFloat64;  ///< the coarser of both
  double max_position_difference_m = 0;
  double max_joint_difference_rad = 0;
  double max_attitude_difference_rad = 0;
  DivergenceTolerances tolerances;
  std::optional<OneStepDifference> one_step;  ///< of engines of the same laws, where it was asked for
  std::optional<DifferenceGrowth> growth;     ///< of the largest of the three; empty where they do not grow
  std::optional<FirstDivergence> first_divergence;  ///< earliest of those watched; empty if all stayed within
  PartingWatch parting{0};  ///< of robots of that leg length; of none nothing is found
};

/// Tells whether all that was compared of a pair lies within `DivergenceTolerances::exact()`.
bool is_same(const PairDifference& pair) noexcept;

/// Returns the angle of the rotation between two orientations, in [0, pi], rad. Accurate near zero.
double attitude_difference(const Quaternion& a, const Quaternion& b) noexcept;

/// Takes one more step of both runs into `result`, which has its tolerances.
/// @returns the largest of its differences of position (m), joints and attitude (rad)
double compare_samples(const TraceSample& a, const TraceSample& b, PairDifference& result);

/// Compares sample by sample over the time both runs cover, into `result`, which has its tolerances.
void compare_traces(const Trace& a, const Trace& b, PairDifference& result);
/// Compares two runs of no engines in the same way.
PairDifference compare_traces(const Trace& a, const Trace& b, const DivergenceTolerances& tolerances);

}  // namespace crossgait
