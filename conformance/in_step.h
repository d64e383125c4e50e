// Two engines in step: how far apart one motion takes them.
#pragma once

#include <functional>

#include "physics/engine/engine.h"

namespace crossgait::conformance {

/// Engines of the same laws differ by rounding alone, at a solver tolerance of 1e-12. Measured over all
/// scenes of tests/parity: 1.2e-13 m (a minute's trot), 3.1e-12 rad (soft contacts), 4.7e-11 N of 7 (falls).
/// A hundred times that, for other compilers and processors, up to the next power of ten.
inline constexpr double kSameLength = 1e-10, kSameAngle = 1e-9, kSameForce = 1e-8;  // m, rad, N

/// Holds the largest differences over a run.
struct Difference {
  double position = 0;  ///< of the base, m
  double joints = 0;    ///< rad
  double attitude = 0;  ///< rad
  double force = 0;     ///< of all contacts together, N, until their number is another
  int counts = 0;       ///< steps with another number of contacts
  int most_contacts = 0;
};

using Targets = std::function<JointTargets(double time)>;

/// Runs both worlds from `start` (home if null) under the same targets, at a solver tolerance of 1e-12.
/// @param while_alike  compare only until another number of contacts touches in the one than in the other
/// @throws std::runtime_error if one diverges
Difference run_in_step(const Engine& a, const Engine& b, WorldSpec spec, const RobotState* start,
                       const Targets& targets, double seconds, bool while_alike = false);

/// Sums up five seconds of the scenes' trot.
struct TrotSummary {
  double distance_m = 0, rms_roll_deg = 0, rms_pitch_deg = 0;
};
/// @throws std::runtime_error if the engine diverges
TrotSummary summarise_trot(const Engine& engine, const char* terrain);

}  // namespace crossgait::conformance
