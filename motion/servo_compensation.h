// What a soft servo has to be asked for so that a moving joint is where it should be.
#pragma once

#include <cmath>

#include "ik/five_bar_leg.h"
#include "physics/robot/leg.h"

namespace crossgait {

/// A servo of stiffness kp trails a moving target by damping / kp (20 ms for kp 1 N m/rad), the passive
/// elbows, which turn twice as fast as the shoulders, drag as much again, and a standing leg gives way under
/// its load (13 mm under half of scara_quadruped's weight). Dry friction of servos and elbows holds them
/// back, too. All of it is known in advance, so targets lead by as much: q* = q + tau / kp. Of the load a
/// share, GaitParameters::load_share. Measured effects: docs/gaits-measured.md.
struct ServoCompensation {
  bool lag = true;            ///< lead by servo damping, dry friction and elbow drag
  double max_lead = 0.5;      ///< rad, bound of the lag correction of one joint
  bool load = true;           ///< carry the gait's share of the load
  double load_depth = 0.005;  ///< a foot this far above the lowest one carries nothing, m

  static constexpr ServoCompensation none() { return {.lag = false, .load = false}; }
};

/// Says how the legs share a load, adding up to 1: evenly among the lowest feet, a foot `depth` above them
/// none, smoothly between. @param feet  targets in the leg frames (z up), m
LegArray<double> load_shares(const LegArray<Vector3>& feet, double depth) noexcept;

/// Describes what resists the motion of a joint.
struct JointDrag {
  double damping = 0;   ///< N m s/rad
  double friction = 0;  ///< dry, N m
  double slow = 1;      ///< rad/s, above 0

  /// Returns the torque to overcome at `rate` (rad/s), N m.
  double torque(double rate) const noexcept { return damping * rate + dry(rate); }
  /// Returns the torque of friction alone: friction rate / sqrt(rate^2 + slow^2), so that a target that turns
  /// round does not jump.
  double dry(double rate) const noexcept {
    return friction * rate /
           std::sqrt(rate * rate + slow * slow);  // hypot takes twice the time, for 1e150 rad/s
  }
};

/// Returns the force (N, leg frame) with which a foot must push to overcome passive elbows' drag while it
/// moves at `velocity` (m/s, leg frame). By virtual work, with the elbow's rate -r.p' / cross(upper, lower),
/// r = foot - shoulder in the leg's plane, from differentiating the chain; the servos' torque for it is J' F.
/// @param leg  placed with its foot on the target
Vector3 elbow_drag_force(const FiveBarGeometry& geometry, const PlacedLeg& leg, const Vector3& velocity,
                         const JointDrag& elbow) noexcept;

}  // namespace crossgait
