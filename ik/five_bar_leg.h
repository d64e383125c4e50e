// Inverse, forward and differential kinematics of a five-bar leg, on a tilt joint (ik/tilt_mount.h) or
// without.
#pragma once

#include "ik/five_bar.h"

namespace crossgait {

/// Holds joint angles of one leg in the robot's sign convention, rad.
/// Without a tilt joint `tilt` is 0.
struct LegAngles {
  double tilt = 0, shoulder_left = 0, shoulder_right = 0, elbow_left = 0, elbow_right = 0;
};

struct LegSolution {
  IkStatus status = IkStatus::kOk;
  LegAngles angles;
};

/// Finds joint angles that put the foot's centre on `target`, or on the workspace's boundary if it is out of
/// reach; see IkStatus. Never NaN, continuous in the target (except on the tilt axis, where "outward" has no
/// direction).
/// @param target  foot centre in the leg frame (x forward, y left, z up: negative below the shoulders), m
[[nodiscard]] LegSolution solve_leg(const FiveBarGeometry& geometry, const Vector3& target,
                                    WorkingMode mode = kDefaultMode) noexcept;

/// Holds the angles that are driven, rad.
struct ServoAngles {
  double tilt = 0, shoulder_left = 0, shoulder_right = 0;
};

struct ServoSolution {
  IkStatus status = IkStatus::kOk;
  ServoAngles angles;
};

/// Describes where the links are with the foot on a target, or as near as they allow: joint limits do not
/// enter.
struct PlacedLeg {
  IkStatus status = IkStatus::kOk;
  double tilt = 0;                 ///< of the joint, rad
  double c = 1, s = 0;             ///< cosine and sine of the outward tilt
  Vector2 foot = Vector2::Zero();  ///< (x, depth below the shoulders) in the leg's plane, m
  ChainLinks a, b;
};

/// Places a leg: the first half of `solve_leg`, which finds no angle but the tilt.
[[nodiscard]] PlacedLeg place_leg(const FiveBarGeometry& geometry, const Vector3& target,
                                  WorkingMode mode = kDefaultMode) noexcept;
/// Finds the servos' angles of a leg that is placed, within their limits.
[[nodiscard]] ServoSolution servos_of(const FiveBarGeometry& geometry, const PlacedLeg& leg) noexcept;

/// Does `solve_leg` without the passive elbows, for control loops: the same angles in two thirds of the time.
[[nodiscard]] ServoSolution solve_servos(const FiveBarGeometry& geometry, const Vector3& target,
                                         WorkingMode mode = kDefaultMode) noexcept;

struct LegPosition {
  bool closed = false;  ///< false: the chains cannot meet at these angles, `foot` is between the elbows
  Vector3 foot = Vector3::Zero();          ///< foot centre in the leg frame, m
  double elbow_left = 0, elbow_right = 0;  ///< passive joint angles, rad
};

/// Computes foot and passive elbows from the three actuated angles (rad). Of the two ways to close the
/// linkage, the one in which the elbows bend as `mode` says: the inverse of `solve_leg` in mode 2, and in
/// every mode if both chains are alike. With unlike chains both ways can bend so in the other modes; then the
/// foot is the lower of the two.
[[nodiscard]] LegPosition forward_leg(const FiveBarGeometry& geometry, double tilt, double shoulder_left,
                                      double shoulder_right, WorkingMode mode = kDefaultMode) noexcept;

/// Computes d foot / d (tilt, shoulder_left, shoulder_right), m/rad, rows x, y, z of the leg
/// frame: velocity of the foot per joint velocity. Differentiates |foot - elbow| = lower link
/// for either chain. Not finite where the lower links are parallel (`LegMargins::parallel` is
/// zero).
Matrix3 leg_jacobian(const FiveBarGeometry& geometry, const LegAngles& q) noexcept;
/// Computes the same of a leg that is placed, without the sines and cosines of its angles.
Matrix3 leg_jacobian(const FiveBarGeometry& geometry, const PlacedLeg& leg) noexcept;

/// Tells which way the elbows bend.
WorkingMode working_mode_of(const FiveBarGeometry& geometry, const LegAngles& q) noexcept;

/// Returns the margins of all joints.
LegMargins leg_margins(const FiveBarGeometry& geometry, const LegAngles& q) noexcept;

}  // namespace crossgait
