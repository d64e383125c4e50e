// Planar kinematics of a two-link chain and of a five-bar in the leg's plane, whose points are written
// (x, depth): forward, and below the shoulders. At zero tilt depth is -z of the leg frame. Angles are
// measured from +x towards the depth, which is right-handed about +y; a link hanging straight down has angle
// pi/2.
#pragma once

#include <optional>

#include "crossgait/ik/geometry.h"

namespace crossgait {

/// What became of an inverse-kinematics request. Whatever the status, the angles are finite.
enum class IkStatus {
  kOk,
  kClampedTooFar,   ///< beyond the links' reach: moved to the nearest reachable point of the leg's plane
  kClampedTooNear,  ///< inside what the links can fold to, or above the shoulders: moved down to the boundary
  kClampedJointLimit,  ///< reachable, but a joint angle was clamped to its limit
  kInvalidTarget,      ///< not finite: the angles are those of a safe neutral point
};

/// "ok", "clamped_too_far", "clamped_too_near", "clamped_joint_limit", "invalid_target".
std::string_view name(IkStatus status) noexcept;

/// On which side the elbows bend. "Up" is a positive angle from upper to lower link, +acos(...): with the
/// foot below the shoulders that elbow lies towards +x of the line from shoulder to foot; "down" towards -x.
enum class WorkingMode {
  kUpDown = 1,    ///< a up, b down: knees crossed inward
  kDownUp = 2,    ///< a down, b up: knees outward; the default
  kBothUp = 3,    ///< both knees forward
  kBothDown = 4,  ///< both knees backward
};

inline constexpr WorkingMode kDefaultMode = WorkingMode::kDownUp;

/// 1 to 4; empty for anything else.
constexpr std::optional<WorkingMode> working_mode(int number) {
  if (number < 1 || number > 4) return std::nullopt;
  return static_cast<WorkingMode>(number);
}

/// +1 for up, -1 for down.
struct ElbowSigns {
  double a, b;
};
constexpr ElbowSigns elbow_signs(WorkingMode mode) {
  return {mode == WorkingMode::kUpDown || mode == WorkingMode::kBothUp ? 1.0 : -1.0,
          mode == WorkingMode::kDownUp || mode == WorkingMode::kBothUp ? 1.0 : -1.0};
}

/// Angles of a two-link chain, rad.
struct TwoLinkSolution {
  IkStatus status = IkStatus::kOk;
  double upper = 0;  ///< plane angle of the upper link, in (-pi, pi]
  double elbow = 0;  ///< from upper to lower link, in [-pi, pi]; its sign is that of `elbow_sign`
};

/// Places the tip of a chain that starts at the origin on (x, depth): the law of cosines,
/// elbow = +-acos((x^2 + depth^2 - L1^2 - L2^2) / (2 L1 L2)). An unreachable point is moved along its ray.
/// @param upper,lower  link lengths L1, L2, m, positive
/// @param elbow_sign   +1 up, -1 down
[[nodiscard]] TwoLinkSolution solve_two_link(double upper, double lower, double x, double depth,
                                             double elbow_sign) noexcept;

/// Both chains of a five-bar.
struct FiveBarSolution {
  IkStatus status = IkStatus::kOk;
  TwoLinkSolution a, b;
};

/// Places the joined tips on (x, depth), measured from midway between the shoulders. An unreachable point is
/// moved as `clamp_to_workspace` does. Chain zero directions and signs do not enter: angles are plane angles.
[[nodiscard]] FiveBarSolution solve_five_bar(const FiveBarGeometry& geometry, double x, double depth,
                                             WorkingMode mode) noexcept;

/// Moves `p` (x, depth; finite) to the reachable set of the leg's plane if it is outside: first down out of
/// the discs that the chains cannot fold into (and to the height of the shoulders), then to the nearest point
/// within reach of both shoulders. Continuous in p.
[[nodiscard]] IkStatus clamp_to_workspace(const FiveBarGeometry& geometry, Vector2& p) noexcept;

/// Upper and lower link of one chain as vectors (x, depth), m.
struct ChainLinks {
  Vector2 upper = Vector2::Zero(), lower = Vector2::Zero();
};

/// Links of `chain` with its tip on the reachable point `p` of the leg's plane. @param elbow_sign +1 up, -1
/// down
ChainLinks place_links(const FiveBarChain& chain, const Vector2& p, double elbow_sign) noexcept;

/// Forward kinematics of the plane.
struct FiveBarClosure {
  bool closed = false;             ///< false if the elbows are too far apart, or coincide: `foot` lies midway
  Vector2 foot = Vector2::Zero();  ///< (x, depth) from midway between the shoulders, m
  ChainLinks a, b;
};

/// The two tips meet in one of two points, mirrored in the line through the elbows; taken is the one whose
/// elbows bend as `mode` says, and the lower one if that leaves a choice.
/// @param upper_a,upper_b  upper links as vectors (x, depth) of their lengths, m
[[nodiscard]] FiveBarClosure close_five_bar(const FiveBarGeometry& geometry, const Vector2& upper_a,
                                            const Vector2& upper_b, WorkingMode mode) noexcept;

/// The cross product in the plane: positive if v lies at a larger plane angle than u.
inline double cross(const Vector2& u, const Vector2& v) { return u.x() * v.y() - u.y() * v.x(); }

}  // namespace crossgait
