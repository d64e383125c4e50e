// One walk: a controller drives a robot in one engine for a while; what happened is summed up and can
// be watched.
#pragma once

#include <chrono>
#include <functional>

#include "motion/closed_loop.h"

namespace crossgait {

/// Holds the timing of a walk. All in simulated seconds.
struct WalkTiming {
  double seconds = 5;  ///< of walking, s
  double control_dt =
      2e-3;  ///< gait, inverse kinematics and servo targets, s; a multiple of the physics step
  double settle_seconds = 0.5;  ///< standing before the first step, s

  /// Longest walk and longest standing before it.
  static constexpr double kMaxSeconds = 1e6, kMaxSettleSeconds = 1e3;

  /// @throws ConfigError if a time is out of range, there are more than 2^31 - 1 control steps, or the
  /// control step is not a whole number of physics steps
  void validate(double physics_dt) const;
  /// Counts the control steps of the walk proper.
  int control_steps() const;
};

/// Holds what an observer sees after every control step. References are valid during the call alone.
struct WalkSample {
  const PhysicsBackend& world;
  const ControlTargets& targets;
};
/// @returns false to end the walk early
using WalkObserver = std::function<bool(const WalkSample&)>;

/// Runs a walk that its caller advances, so that several can go in step. World and its observers stay the
/// caller's.
class Walk {
 public:
  /// Puts the robot down and lets it settle.
  /// @param terminations  outcomes that end the walk before its time
  /// @throws ConfigError for impossible timing or a controller that cannot stand there
  Walk(PhysicsBackend& world, ControllerPtr controller, const WalkTiming& timing, const Start& start = {},
       const OutcomeSet& terminations = OutcomeSet::of_walks());

  /// Makes one more control step. @returns false, with nothing to show, once the walk is over
  bool advance();
  /// Returns what there is to see after the last control step.
  WalkSample sample() const { return {world_, loop_.targets()}; }
  /// Sums up the walk up to here; its wall time is what was spent in this object.
  MotionSummary summary() const;

 private:
  using Clock = std::chrono::steady_clock;

  PhysicsBackend& world_;
  ControllerPtr controller_;
  ClosedLoop loop_;
  int steps_left_;
  Clock::duration spent_{};
};

/// Runs the whole walk at once. @throws ConfigError as Walk does
MotionSummary run_walk(PhysicsBackend& world, const ControllerPtr& controller, const WalkTiming& timing,
                       const WalkObserver& observer = {}, const Start& start = {},
                       const OutcomeSet& terminations = OutcomeSet::of_walks());

}  // namespace crossgait
