// What a soft servo has to be asked for so that a moving joint is where it should be.
#pragma once

#include "crossgait/ik/leg_kinematics.h"

namespace crossgait {

/// A servo of stiffness kp trails a moving target by damping / kp (20 ms for kp 1 N m/rad), and the passive
/// elbows, which turn twice as fast as the shoulders, drag as much again. Both are known in advance, so
/// targets lead by as much: q* = q + tau_damping / kp. Measured effect on a trot: docs/gaits.md. (Leading the
/// weight of a touching-down leg as well was tried: the diagonal pair then pushes the body over, RMS roll 7
/// degrees instead of 1.)
struct ServoCompensation {
  bool lag = true;
  double max_lead = 0.5;  ///< rad, bound of the correction of one joint

  static constexpr ServoCompensation none() { return {.lag = false}; }
};

/// Servo torques (tilt, shoulder_left, shoulder_right; N m) that overcome the viscous friction of the passive
/// elbows while the foot moves at `velocity` (m/s, leg frame). By virtual work: tau = J' F, with the elbow's
/// rate -r.p' / cross(upper, lower), r = foot - shoulder in the leg's plane, from differentiating the chain.
/// @param foot     position in the leg frame, m, within reach
/// @param angles   the joint angles there
/// @param elbow_damping  N m s/rad
Vector3 elbow_drag_torque(const FiveBarGeometry& geometry, const Vector3& foot, const LegAngles& angles,
                          WorkingMode mode, const Vector3& velocity, double elbow_damping) noexcept;

}  // namespace crossgait
