// Planar kinematics of two links on each other: one leg of a five-bar, or thigh and shin of a serial leg.
// Points of the leg's plane are written (x, depth): forward, and below the shoulders or the hip. At zero tilt
// depth is -z of the leg frame. Angles are measured from +x towards the depth, which is right-handed about
// +y; a link hanging straight down has angle pi/2.
#pragma once

#include <algorithm>
#include <cmath>

#include "ik/ik_status.h"
#include "physics/core/math.h"

namespace crossgait {

using Vector2 = Eigen::Vector2d;

struct JointLimits {
  double lower = -3.14159265358979323846;  ///< rad
  double upper = 3.14159265358979323846;   ///< rad
};

/// Describes shoulder, upper link, elbow, lower link; of a serial leg hip, thigh, knee, shin.
struct TwoLinkChain {
  double shoulder_x = 0;        ///< of the shoulder axis in the leg frame, m
  double upper = 0;             ///< length of the upper link, m
  double lower = 0;             ///< length of the lower link, m
  Vector2 upper_zero = {0, 1};  ///< unit direction of the upper link at zero shoulder angle and zero tilt
  Vector2 lower_zero = {1,
                        0};  ///< (cos, sin) of the plane angle from upper to lower link at zero elbow angle
  double shoulder_sign = 1;  ///< +1 if a positive joint angle increases the plane angle, else -1
  double elbow_sign = 1;     ///< the same for the elbow
  JointLimits shoulder_limits, elbow_limits;
};

/// Holds the upper and lower link of one chain as vectors (x, depth), m.
struct ChainLinks {
  Vector2 upper = Vector2::Zero(), lower = Vector2::Zero();
};

/// Places the links of `chain` with its tip on the reachable point `p` of the leg's plane. "Up" is a positive
/// angle from upper to lower link, +acos(...): with the tip below the shoulder the elbow lies towards +x of
/// the line from shoulder to tip; "down" towards -x. @param elbow_sign +1 up, -1 down
ChainLinks place_links(const TwoLinkChain& chain, const Vector2& p, double elbow_sign) noexcept;

/// Holds angles of a two-link chain, rad.
struct TwoLinkSolution {
  IkStatus status = IkStatus::kOk;
  double upper = 0;  ///< plane angle of the upper link, in (-pi, pi]
  double elbow = 0;  ///< from upper to lower link, in [-pi, pi]; its sign is that of `elbow_sign`
};

/// Computes plane angles of `links`, the elbow's with the sign `elbow_sign`; status kOk.
TwoLinkSolution plane_angles(const ChainLinks& links, double elbow_sign) noexcept;

/// Places the tip of a chain that starts at the origin on (x, depth): the law of cosines,
/// elbow = +-acos((x^2 + depth^2 - L1^2 - L2^2) / (2 L1 L2)). An unreachable point is moved along its ray.
/// @param upper,lower  link lengths L1, L2, m, positive
/// @param elbow_sign   +1 up, -1 down
[[nodiscard]] TwoLinkSolution solve_two_link(double upper, double lower, double x, double depth,
                                             double elbow_sign) noexcept;

/// Moves `d`, from the shoulder to the tip, along its ray to what links of these lengths reach. The ray of
/// the shoulder itself is undefined: straight down.
[[nodiscard]] IkStatus clamp_to_reach(const TwoLinkChain& chain, Vector2& d) noexcept;

/// A chain of equal links could fold to a point, where its direction is undefined: keep this far away, m.
inline constexpr double kSmallestFold = 1e-6;

inline double largest_reach(const TwoLinkChain& c) { return c.upper + c.lower; }
inline double smallest_reach(const TwoLinkChain& c) {
  return std::max(std::abs(c.upper - c.lower), kSmallestFold);
}

/// Returns the cross product in the plane: positive if v lies at a larger plane angle than u.
inline double cross(const Vector2& u, const Vector2& v) { return u.x() * v.y() - u.y() * v.x(); }

/// Returns `v` turned by the plane angle of cosine c and sine s.
inline Vector2 rotate(const Vector2& v, double c, double s) {
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

/// Returns the plane angle from `from` to `to`, rad.
inline double angle_between(const Vector2& from, const Vector2& to) {
  return std::atan2(cross(from, to), from.dot(to));
}

/// Returns joint angles of placed links, in [-pi, pi]; those below give the links of joint angles.
inline double shoulder_angle(const TwoLinkChain& c, const ChainLinks& links) {
  return c.shoulder_sign * angle_between(c.upper_zero, links.upper);
}
inline double elbow_angle(const TwoLinkChain& c, const ChainLinks& links) {
  return c.elbow_sign * angle_between(rotate(links.upper, c.lower_zero.x(), c.lower_zero.y()), links.lower);
}
inline Vector2 upper_link(const TwoLinkChain& c, double shoulder) {
  return c.upper * rotate(c.upper_zero, std::cos(shoulder), c.shoulder_sign * std::sin(shoulder));
}
inline Vector2 lower_link(const TwoLinkChain& c, const Vector2& upper, double elbow) {
  const Vector2 zero = rotate(upper, c.lower_zero.x(), c.lower_zero.y()) / c.upper;
  return c.lower * rotate(zero, std::cos(elbow), c.elbow_sign * std::sin(elbow));
}

/// Says how far a posture is from trouble. All rad, zero at the edge.
struct LegMargins {
  double joint_limit = 0;  ///< smallest distance of the joints to a limit; negative beyond it
  double serial =
      0;  ///< smallest bend of an elbow from straight or folded: there the foot cannot move radially
  double parallel =
      0;  ///< angle between the lines of the lower links: at zero the foot can move with locked servos
};

/// Returns the bend of the elbow from straight or folded, whichever is nearer, rad.
inline double elbow_margin(const ChainLinks& links) {
  return std::atan2(std::abs(cross(links.upper, links.lower)), std::abs(links.upper.dot(links.lower)));
}

/// Returns the distance to the nearer limit, negative beyond it, rad.
inline double limit_margin(double angle, const JointLimits& limits) {
  return std::min(angle - limits.lower, limits.upper - angle);
}

/// @returns whether `angle` changed.
inline bool clamp_angle(double& angle, const JointLimits& limits) {
  const double wanted = angle;
  angle = std::min(std::max(angle, limits.lower), limits.upper);
  return angle != wanted;
}

/// Turns `angle` by whole turns nearest to the middle of `limits`; of limits wider than a turn, to the angle
/// nearest to zero that has half a turn on either side.
inline double nearest_turn(double angle, const JointLimits& limits) {
  constexpr double kTurn = 6.283185307179586477;
  double middle = (limits.lower + limits.upper) / 2;
  const double spare = (limits.upper - limits.lower - kTurn) / 2;
  if (spare > 0) middle = std::clamp(0.0, middle - spare, middle + spare);
  return angle + kTurn * std::nearbyint((middle - angle) / kTurn);
}

/// Applies `nearest_turn`, then `clamp_angle`. @returns whether a limit binds.
inline bool fit_angle(double& angle, const JointLimits& limits) {
  angle = nearest_turn(angle, limits);
  return clamp_angle(angle, limits);
}

}  // namespace crossgait
