// The servo law shared by every engine.
#pragma once

#include <algorithm>
#include <optional>

#include "physics/robot/implicit_servo.h"
#include "physics/robot/robot.h"

namespace crossgait {

/// Computes the torque that a servo makes, N m:
///
///     tau = clamp(kp D(target - measured) - kd qd, -effort(-qd), effort(qd))
///
/// D is the dead zone of the play between motor and joint: less half of Joint::backlash on either side;
/// within it there is no torque, and outside none that would pull the joint back through it (Nordin and
/// Gutman, Controlling mechanical systems with backlash - a survey, 2002). effort(v) is Joint::effort_limit
/// up to Joint::corner_speed in the torque's direction and falls linearly to nothing at Joint::no_load_speed;
/// a drive brakes with all its torque. Without backlash and no_load_speed, which is the default,
/// tau = clamp(kp (target - measured) - kd qd, +-effort_limit). A joint may have another limit in the
/// direction of negative torque (Joint::effort_negative).
/// @param measured  the joint's angle as the servo knows it, rad
double servo_torque(const Joint& joint, double target, double measured, double qd) noexcept;

/// Tells whether what a servo does in a step hangs on how the step ends.
inline bool is_implicit(const Joint& joint) noexcept {
  return joint.actuated && joint.implicit_stiffness * joint.kp + joint.implicit_damping * joint.kd > 0;
}

/// Returns what an implicit servo's torque falls by per acceleration in a step of h s
/// (ImplicitServo::inertia), kg m^2; 0 of an explicit one.
inline double servo_inertia(const Joint& joint, double h) noexcept {
  return joint.implicit_stiffness * joint.kp * h * h + joint.implicit_damping * joint.kd * h;
}

/// Describes the servo law with shares s of its spring and d of its damper (Joint::implicit_stiffness,
/// implicit_damping) taken at the end of a step of h s, where the joint turns at v' and its angle is q + h v'
/// (semi-implicit Euler): with a = (v' - v) / h
///
///     tau = clamp(kp D(target - measured - s h v') - kd ((1 - d) v + d v'), -effort(-v), effort(v))
///         = clamp(kp D(target - measured - s h v) - kd v - (s kp h^2 + d kd h) a, ...)
///
/// The play D and the bounds are those of the step's beginning.
/// @param h  physics step, s
/// @returns nothing where no torque is to be had: within the play, or beyond no_load_speed
std::optional<ImplicitServo> implicit_servo(const Joint& joint, int index, double target, double measured,
                                            double qd, double h) noexcept;

/// Clips a target to its servo's range, then to the joint's limits, rad. The two need not overlap.
inline double clip_target(const Joint& joint, double target) noexcept {
  return std::clamp(std::clamp(target, joint.target_lower, joint.target_upper), joint.lower, joint.upper);
}

/// Returns what a step of h s accelerates in a joint besides its bodies, kg m^2: its armature, and of a
/// damper d that acts in a share s on the speed at which the step ends, s d h: from I (v' - v) = h (tau - d
/// ((1 - s) v + s v')) comes (I + s d h) (v' - v) = h (tau - d v). All of it is MuJoCo's joint damping
/// (mj_Euler, mj_implicit), but that here contacts are solved with it and there before it.
inline double step_armature(const Joint& joint, double h) noexcept {
  return joint.armature + joint.implicit_joint_damping * joint.damping * h;
}

/// Returns the torque of what a joint has but a servo at a step's beginning, N m:
/// -damping qd - stiffness (q - spring_reference). What a damper does on the speed at its end is
/// step_armature's.
inline double passive_torque(const Joint& joint, double q, double qd) noexcept {
  return -joint.damping * qd - joint.stiffness * (q - joint.spring_reference);
}

/// Returns the largest torque in the direction of negative torque, N m.
inline double negative_effort(const Joint& joint) noexcept {
  return joint.effort_negative > 0 ? joint.effort_negative : joint.effort_limit;
}

}  // namespace crossgait
