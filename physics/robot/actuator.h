// The servo law shared by every engine.
#pragma once

#include "physics/robot/robot.h"

namespace crossgait {

/// The torque that a servo makes, N m:
///
///     tau = clamp(kp D(target - measured) - kd qd, -effort(-qd), effort(qd))
///
/// D is the dead zone of the play between motor and joint: less half of Joint::backlash on either side;
/// within it there is no torque, and outside none that would pull the joint back through it (Nordin and
/// Gutman, Controlling mechanical systems with backlash - a survey, 2002). effort(v) is Joint::effort_limit
/// up to Joint::corner_speed in the torque's direction and falls linearly to nothing at Joint::no_load_speed;
/// a drive brakes with all its torque. Without backlash and no_load_speed, which is the default,
/// tau = clamp(kp (target - measured) - kd qd, +-effort_limit).
/// @param measured  the joint's angle as the servo knows it, rad
double servo_torque(const Joint& joint, double target, double measured, double qd) noexcept;

}  // namespace crossgait
