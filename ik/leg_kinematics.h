// Inverse, forward and differential kinematics of a five-bar leg on a tilt joint.
//
// With the foot at lateral distance Y = side y + a (outward) and depth Z = b - z (down) from the tilt axis,
// a = axis_to_plane_out and b = axis_to_shoulder_down:
//   D = sqrt(Y^2 + Z^2 - a^2),  outward tilt = atan2(Y, Z) - atan2(a, D),  depth in the leg's plane d = D -
//   b.
// With a = b = 0 that is the guide's tilt = atan2(y, |z|).
#pragma once

#include "crossgait/ik/five_bar.h"

namespace crossgait {

/// Joint angles of one leg in the robot's sign convention, rad.
struct LegAngles {
  double tilt = 0, shoulder_left = 0, shoulder_right = 0, elbow_left = 0, elbow_right = 0;
};

struct LegSolution {
  IkStatus status = IkStatus::kOk;
  LegAngles angles;
};

/// Joint angles that put the foot's centre on `target`, or on the workspace's boundary if it is out of reach;
/// see IkStatus. Never NaN, continuous in the target (except on the tilt axis, where "outward" has no
/// direction).
/// @param target  foot centre in the leg frame (x forward, y left, z up: negative below the shoulders), m
[[nodiscard]] LegSolution solve_leg(const FiveBarGeometry& geometry, const Vector3& target,
                                    WorkingMode mode = kDefaultMode) noexcept;

/// The angles that are driven, rad.
struct ServoAngles {
  double tilt = 0, shoulder_left = 0, shoulder_right = 0;
};

struct ServoSolution {
  IkStatus status = IkStatus::kOk;
  ServoAngles angles;
};

/// `solve_leg` without the passive elbows, for control loops: the same angles in two thirds of the time.
[[nodiscard]] ServoSolution solve_servos(const FiveBarGeometry& geometry, const Vector3& target,
                                         WorkingMode mode = kDefaultMode) noexcept;

struct LegPosition {
  bool closed = false;  ///< false: the chains cannot meet at these angles, `foot` is between the elbows
  Vector3 foot = Vector3::Zero();          ///< foot centre in the leg frame, m
  double elbow_left = 0, elbow_right = 0;  ///< passive joint angles, rad
};

/// Foot and passive elbows from the three actuated angles (rad). Of the two ways to close the linkage, the
/// one in which the elbows bend as `mode` says: the inverse of `solve_leg` in mode 2, and in every mode if
/// both chains are alike. With unlike chains both ways can bend so in the other modes; then the foot is the
/// lower of the two.
[[nodiscard]] LegPosition forward_leg(const FiveBarGeometry& geometry, double tilt, double shoulder_left,
                                      double shoulder_right, WorkingMode mode = kDefaultMode) noexcept;

/// d foot / d (tilt, shoulder_left, shoulder_right), m/rad, rows x, y, z of the leg frame: velocity of the
/// foot per joint velocity. Differentiates |foot - elbow| = lower link for either chain. Not finite where the
/// lower links are parallel
/// (`LegMargins::parallel` is zero).
Matrix3 leg_jacobian(const FiveBarGeometry& geometry, const LegAngles& q) noexcept;

/// How far a posture is from trouble. All rad, zero at the edge.
struct LegMargins {
  double joint_limit = 0;  ///< smallest distance of the five joints to a limit; negative beyond it
  double serial =
      0;  ///< smallest bend of an elbow from straight or folded: there the foot cannot move radially
  double parallel =
      0;  ///< angle between the lines of the lower links: at zero the foot can move with locked servos
};

LegMargins leg_margins(const FiveBarGeometry& geometry, const LegAngles& q) noexcept;

}  // namespace crossgait
