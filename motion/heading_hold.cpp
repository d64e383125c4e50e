#include "motion/heading_hold.h"

#include <algorithm>
#include <cmath>

#include "physics/core/heading.h"

namespace crossgait {

double HeadingHoldState::update(const HeadingHold& options, const RobotState& state, double commanded,
                                double dt) noexcept {
  if (!options.on) return 0;
  const double heading = yaw_of(state.q_WB);
  if (!wanted_) wanted_ = heading;
  const double behind = wrapped(*wanted_ - heading);
  *wanted_ += commanded * dt;
  return std::clamp(options.gain * behind, -options.max_rate, options.max_rate);
}

}  // namespace crossgait
