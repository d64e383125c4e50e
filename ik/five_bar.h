// Planar kinematics of a five-bar: two two-link chains (ik/two_link_chain.h) whose tips are one point. Points
// of the leg's plane are (x, depth) and angles plane angles, as there.
#pragma once

#include <optional>

#include "ik/geometry.h"
#include "ik/two_link_chain.h"

namespace crossgait {

/// Says on which side the elbows bend; up and down as in `place_links`.
enum class WorkingMode {
  kUpDown = 1,    ///< a up, b down: knees crossed inward
  kDownUp = 2,    ///< a down, b up: knees outward; the default
  kBothUp = 3,    ///< both knees forward
  kBothDown = 4,  ///< both knees backward
};

inline constexpr WorkingMode kDefaultMode = WorkingMode::kDownUp;

/// Returns modes 1 to 4; empty for anything else.
constexpr std::optional<WorkingMode> working_mode(int number) {
  if (number < 1 || number > 4) return std::nullopt;
  return static_cast<WorkingMode>(number);
}

/// Holds +1 for up, -1 for down.
struct ElbowSigns {
  double a, b;
};
constexpr ElbowSigns elbow_signs(WorkingMode mode) {
  return {mode == WorkingMode::kUpDown || mode == WorkingMode::kBothUp ? 1.0 : -1.0,
          mode == WorkingMode::kDownUp || mode == WorkingMode::kBothUp ? 1.0 : -1.0};
}

/// Holds both chains of a five-bar.
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

/// Holds what forward kinematics of the plane find.
struct FiveBarClosure {
  bool closed = false;             ///< false if the elbows are too far apart, or coincide: `foot` lies midway
  Vector2 foot = Vector2::Zero();  ///< (x, depth) from midway between the shoulders, m
  ChainLinks a, b;
};

/// Finds where the two tips meet: one of two points, mirrored in the line through the elbows; taken is the
/// one whose elbows bend as `mode` says, and the lower one if that leaves a choice.
/// @param upper_a,upper_b  upper links as vectors (x, depth) of their lengths, m
[[nodiscard]] FiveBarClosure close_five_bar(const FiveBarGeometry& geometry, const Vector2& upper_a,
                                            const Vector2& upper_b, WorkingMode mode) noexcept;

}  // namespace crossgait
