// Keeps a walking robot on the heading that its command leads to. The one feedback loop in the stack: without
// it a gait is open loop, and a robot that slips turns wherever its feet happened to slip.
#pragma once

#include <optional>

#include "gait/scale.h"
#include "physics/robot/state.h"

namespace crossgait {

/// Adds turning to the command's yaw rate: gain x (heading wanted - heading), bounded. The heading wanted is
/// that of the first look, turned by the commanded yaw rate from then on. Proportional control alone: a
/// commanded turn is followed at its rate, a little behind in angle.
struct HeadingHold {
  bool on = true;
  double gain = 2;  ///< 1/s. A gait answers within a cycle, so that gain x cycle_time should stay below 1
  double max_rate = 0.5;  ///< rad/s

  static constexpr HeadingHold none() { return {.on = false}; }
};

/// Scales `hold` for gaits of this size: cycles are longer by `time()`, so it answers as much slower.
inline HeadingHold scaled(HeadingHold hold, const GaitScale& scale) noexcept {
  hold.gain /= scale.time();
  hold.max_rate /= scale.time();
  return hold;
}

/// Remembers what one motion's heading hold needs. A value: saved and restored with the motion.
class HeadingHoldState {
 public:
  /// Makes the next look begin a motion.
  void restart() noexcept { wanted_.reset(); }

  /// @param commanded  yaw rate that is commanded for the next `dt` (s), rad/s
  /// @returns the yaw rate to add to it, rad/s; 0 if `options` has it off
  double update(const HeadingHold& options, const RobotState& state, double commanded, double dt) noexcept;

 private:
  std::optional<double> wanted_;  // rad
};

}  // namespace crossgait
