#include "crossgait/physics/actuator.h"

#include <algorithm>

namespace crossgait {

double servo_torque(const Joint& joint, double target, double q, double qd) noexcept {
  return std::clamp(joint.kp * (target - q) - joint.kd * qd, -joint.effort_limit, joint.effort_limit);
}

}  // namespace crossgait
