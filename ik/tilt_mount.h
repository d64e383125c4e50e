// How a leg hangs on the base: its plane turns about an axis along x, the tilt of a five-bar or the abduction
// of a serial leg.
//
// With the foot at lateral distance Y = side y + a (outward) and depth Z = b - z (down) from the tilt axis,
// a = axis_to_plane_out and b = axis_to_shoulder_down:
//   D = sqrt(Y^2 + Z^2 - a^2),  outward tilt = atan2(Y, Z) - atan2(a, D),  depth in the leg's plane d = D -
//   b.
// With a = b = 0 that is the guide's tilt = atan2(y, |z|).
#pragma once

#include <cmath>

#include "ik/two_link_chain.h"

namespace crossgait {

/// The **leg frame** has its origin in the plane of the foot at zero tilt, on the hip axis of a serial leg
/// and midway between the shoulder axes of a five-bar; its axes are those of the base (x forward, y left, z
/// up): p_BF = p_BL + p_LF. What is below the shoulders has negative z.
struct TiltMount {
  Vector3 p_BL = Vector3::Zero();    ///< origin of the leg frame in the base frame, m
  double side = 1;                   ///< +1 where outward is +y (left legs), -1 for right legs
  double axis_to_plane_out = 0;      ///< from the tilt axis to the plane of the leg, outward at zero tilt, m
  double axis_to_shoulder_down = 0;  ///< from the tilt axis down to the shoulder axes at zero tilt, m
  double tilt_sign = 1;              ///< +1 if a positive tilt angle swings the foot outward, else -1
  JointLimits tilt_limits;
};

/// Largest misalignment of a joint axis that counts as none, rad. Files written by programs with six decimals
/// are within 1e-5; frames turned on purpose are off by 1e-3 and more. The foot is then wrong by at most 2e-4
/// (r1 + r2 + r3), r being its distances from the three joints (an axis off by e turns a point at distance r
/// along a circle that is nowhere farther than 2 e r from the right one): 0.2 mm for a leg of 0.5 m at the
/// very worst.
inline constexpr double kAxisAlignment = 1e-4;

/// Describes the plane through a target: what inverse kinematics do about the tilt axis.
struct TiltedPlane {
  double tilt = 0;        ///< of the joint, rad
  double c = 1, s = 0;    ///< cosine and sine of the outward tilt
  double D = 0;           ///< of the foot below the axis, in the plane, m
  bool too_near = false;  ///< the target is nearer to the axis than D_min allows; D is D_min
};

/// @param y,z    of the target in the leg frame, m
/// @param D_min  smallest D, m, not negative
inline TiltedPlane plane_through(const TiltMount& g, double y, double z, double D_min) {
  const double a = g.axis_to_plane_out, b = g.axis_to_shoulder_down;
  const double Y = g.side * y + a, Z = b - z;
  const double D2 = Y * Y + Z * Z - a * a;
  const bool too_near = D2 < D_min * D_min;
  const double D = too_near ? D_min : std::sqrt(D2);
  // The difference of the two angles of the tilt equation, as one.
  const Vector2 outward(Z * D + Y * a, Y * D - Z * a);
  const double norm = outward.norm();
  const double tilt = g.tilt_sign * std::atan2(outward.y(), outward.x());
  if (norm == 0) return {tilt, 1, 0, D, too_near};  // on the axis
  return {tilt, outward.x() / norm, outward.y() / norm, D, too_near};
}

/// Places the foot in the leg frame from its place in the leg's plane and the outward tilt (cos, sin).
inline Vector3 tilted(const TiltMount& g, const Vector2& p, double c, double s) {
  const double a = g.axis_to_plane_out, b = g.axis_to_shoulder_down, D = p.y() + b;
  return {p.x(), g.side * (a * c + D * s - a), b - (D * c - a * s)};
}

/// Turns a velocity in the leg's plane in the same way.
inline Vector3 tilted_velocity(const TiltMount& g, const Vector2& v, double c, double s) {
  return {v.x(), g.side * s * v.y(), -c * v.y()};
}

/// Computes d foot / d tilt, m/rad, with the foot `depth` below the shoulders.
inline Vector3 tilt_column(const TiltMount& g, double depth, double c, double s) {
  const double D = depth + g.axis_to_shoulder_down, a = g.axis_to_plane_out;
  return g.tilt_sign * Vector3(0, g.side * (D * c - a * s), D * s + a * c);
}

/// How far a target may be from the plane of a leg that cannot turn aside, m: rounding.
inline constexpr double kOffPlane = 1e-9;

/// Coordinates are clamped to this before they are squared, m: no leg reaches so far, and no square
/// overflows.
inline constexpr double kFar = 1e3;

}  // namespace crossgait
