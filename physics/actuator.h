// The servo law shared by every engine.
#pragma once

#include "crossgait/physics/robot.h"

namespace crossgait {

/// tau = clamp(kp (target - q) - kd qd, +-effort_limit), N m.
double servo_torque(const Joint& joint, double target, double q, double qd) noexcept;

}  // namespace crossgait
