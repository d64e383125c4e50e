// What became of an inverse-kinematics request.
#pragma once

#include <string_view>

namespace crossgait {

/// Says what came of inverse kinematics; whatever the status, the angles are finite.
enum class IkStatus {
  kOk,
  kClampedTooFar,      ///< beyond the links' reach: moved to the nearest reachable point of the leg's plane
  kClampedTooNear,     ///< inside what the links can fold to, or above the shoulders of a five-bar: moved out
  kClampedJointLimit,  ///< reachable, but a joint angle was clamped to its limit
  kInvalidTarget,      ///< not finite: the angles are those of a safe neutral point
};

/// Names a status: "ok", "clamped_too_far", "clamped_too_near", "clamped_joint_limit", "invalid_target".
std::string_view name(IkStatus status) noexcept;

/// What is searched for numerically is found if the foot is this near to its target, m.
inline constexpr double kConverged = 1e-10;

}  // namespace crossgait
