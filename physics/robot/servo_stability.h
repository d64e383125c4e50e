// Whether steps of time are short enough for a robot's servos.
#pragma once

#include <optional>

#include "physics/robot/robot.h"

namespace crossgait {

/// Describes the joint whose servo loop steps of time are the longest for.
struct ServoLoop {
  int joint = -1;      ///< index
  double ratio = 0;    ///< kd dt / I + kp dt^2 / (2 I): from 2 on it is unstable, from 1 on it overshoots
  double inertia = 0;  ///< I, that the joint moves in that loop, kg m^2
};

/// Finds that joint, in the home pose, base and other joints free, loops open. Torques are those of a step's
/// beginning, and speeds change before angles (semi-implicit Euler), for which a servo of stiffness kp and
/// damping kd on an inertia I is stable while kd dt / I + kp dt^2 / (2 I) < 2: the Jury criterion of z^2 - (2
/// - kd dt / I - kp dt^2 / I) z + (1 - kd dt / I). Of several joints it is the largest eigenvalue of M^-1 (D
/// dt + K dt^2 / 2), D with the joints' own damping and K with their springs. Of implicit servos (actuator.h)
/// what hangs on the step's end is an inertia in M, s kp dt^2 + d kd dt, and s kp dt a damping in D; of
/// joints' own damping it is an inertia likewise.
/// @param dt  physics step, s  @returns nothing for a robot without servos, springs and damping
std::optional<ServoLoop> stiffest_servo_loop(const RobotDescription& robot, double dt);

}  // namespace crossgait
