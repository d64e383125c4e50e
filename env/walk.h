// One walk: a source of targets drives a robot in one engine for a while; what happened is summed up and can
// be watched.
#pragma once

#include <functional>

#include "crossgait/env/closed_loop.h"

namespace crossgait {

/// Timing of a walk. All in simulated seconds.
struct WalkTiming {
  double seconds = 5;  ///< of walking, s
  double control_dt =
      2e-3;  ///< gait, inverse kinematics and servo targets, s; a multiple of the physics step
  double settle_seconds = 0.5;  ///< standing before the first step, s

  /// @throws ConfigError if a time is out of range, or the control step is not a whole number of physics
  /// steps
  void validate(double physics_dt) const;
  /// Control steps of the walk proper.
  int control_steps() const;
};

/// What an observer sees after every control step. References are valid during the call alone.
struct WalkSample {
  const PhysicsBackend& world;
  const ControlTargets& targets;
};
/// @returns false to end the walk early
using WalkObserver = std::function<bool(const WalkSample&)>;

/// @param ends  outcomes that end the walk before its time
/// @throws ConfigError for impossible timing or a source that cannot stand there
MotionSummary run_walk(PhysicsBackend& world, const TargetSource& source, const WalkTiming& timing,
                       const WalkObserver& observer = {}, const Start& start = {},
                       const OutcomeSet& ends = OutcomeSet::of_walks());

}  // namespace crossgait
