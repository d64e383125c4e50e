// A servo whose torque hangs on how a step ends.
#pragma once

#include <algorithm>

namespace crossgait {

/// Describes what such a servo does in one step of h s, whose joint accelerates by a = (v' - v) / h:
///
///     tau = clamp(torque - inertia a, lower, upper)
///
/// It is a constraint row with a bounded impulse: an engine solves it along with its contacts.
struct ImplicitServo {
  int joint = -1;               ///< as in RobotDescription::joint
  double torque = 0;            ///< at no acceleration and without bounds, N m
  double inertia = 0;           ///< > 0, kg m^2
  double lower = 0, upper = 0;  ///< N m, lower < upper

  double torque_at(double acceleration) const noexcept {
    return std::clamp(torque - inertia * acceleration, lower, upper);
  }
};

}  // namespace crossgait
