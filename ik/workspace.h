// What a leg reaches: sampled grids, boxes of safe targets, and how far a foot can go in a direction.
#pragma once

#include <cstddef>
#include <vector>

#include "ik/leg_kinematics.h"

namespace crossgait {

/// Describes an axis-aligned box of foot targets in the leg frame (z up), m.
struct TargetBox {
  Vector3 min = Vector3::Zero(), max = Vector3::Zero();
};

/// Says what makes a target safe: reachable, and this far from trouble (rad; see LegMargins).
struct RequiredMargins {
  double joint_limit = 0.05;
  double serial = 0.15;
  double parallel = 0.15;
};

/// Holds one target's verdict.
struct WorkspaceSample {
  IkStatus status = IkStatus::kInvalidTarget;
  LegMargins margins;  ///< of the posture; meaningful where status is kOk
};

WorkspaceSample sample_target(const LegKinematics& leg, const Vector3& target, LegBranch branch) noexcept;

bool is_safe(const WorkspaceSample& sample, const RequiredMargins& required) noexcept;
bool is_safe(const LegKinematics& leg, const Vector3& target, LegBranch branch,
             const RequiredMargins& required) noexcept;

/// Holds a regular grid over a box, x fastest, then y, then z. Both ends of every side are sampled.
struct WorkspaceMap {
  TargetBox box;
  std::array<int, 3> count = {};  ///< samples per side, at least 2 each
  std::vector<WorkspaceSample> samples;

  Vector3 target(int ix, int iy, int iz) const;
  const WorkspaceSample& at(int ix, int iy, int iz) const;
  /// Returns the fraction of the samples that are reachable, 0 to 1.
  double reachable_fraction() const;
};

/// Returns the smallest box around everything the links reach, from the height of the shoulders down.
TargetBox reach_bounds(const LegKinematics& leg);

inline constexpr std::size_t kMaxWorkspaceSamples = 1'000'000;

/// @throws ConfigError unless every count is at least 2, they are kMaxWorkspaceSamples together at most, and
/// the box is finite and not inverted
WorkspaceMap sample_workspace(const LegKinematics& leg, LegBranch branch, const TargetBox& box,
                              const std::array<int, 3>& count);

/// Returns how far a foot can go from `start` along the unit vector `direction` with every target on the way
/// safe, m; zero if `start` itself is not safe. Found by steps of 0.5 mm (of a leg of more than 0.25 m: as
/// many steps) and bisection to 1 um.
double safe_distance(const LegKinematics& leg, const Vector3& start, const Vector3& direction,
                     LegBranch branch, const RequiredMargins& required = {}) noexcept;

/// Finds a box of safe targets around `centre` that cannot grow by a millimetre (of a large leg: as above) on
/// any side: its faces move outward in turn until a target on the new face, sampled every 2 mm or closer, is
/// not safe. Of zero size if `centre` is not safe.
TargetBox safe_box(const LegKinematics& leg, const Vector3& centre, LegBranch branch,
                   const RequiredMargins& required = {});

}  // namespace crossgait
