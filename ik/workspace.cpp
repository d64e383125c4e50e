#include "ik/workspace.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

constexpr double kWalk = 5e-4;        // m, step of safe_distance
constexpr double kResolution = 1e-6;  // m, its bisection
constexpr double kGrow = 1e-3;        // m, by which a face of safe_box moves
constexpr double kSpacing = 2e-3;     // m, between targets on a face

int samples_along(double length, double spacing) { return 2 + static_cast<int>(length / spacing); }

/// Whether every target on the face of `box` at `at` across `axis` is safe.
template <typename Safe>
bool face_is_safe(const TargetBox& box, int axis, double at, double spacing, const Safe& safe) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const int nu = samples_along(box.max[u] - box.min[u], spacing),
            nv = samples_along(box.max[v] - box.min[v], spacing);
  Vector3 target = box.min;
  target[axis] = at;
  for (int i = 0; i < nu; ++i) {
    target[u] = box.min[u] + (box.max[u] - box.min[u]) * i / (nu - 1);
    for (int j = 0; j < nv; ++j) {
      target[v] = box.min[v] + (box.max[v] - box.min[v]) * j / (nv - 1);
      if (!safe(target)) return false;
    }
  }
  return true;
}

/// What a foot in a plane that tilts can reach: from `x[0]` to `x[1]` forward, `down` below its joints.
TargetBox around(const TiltMount& mount, const std::array<double, 2>& x, double down) {
  const double a = mount.axis_to_plane_out, b = mount.axis_to_shoulder_down;
  const double radius = std::hypot(a, down + b);  // of the foot about the tilt axis
  const double inward = mount.side * (-radius - a), outward = mount.side * (radius - a);
  return {{x[0], std::min(inward, outward), b - radius}, {x[1], std::max(inward, outward), 0}};
}

/// Lengths on which boxes grow and distances are stepped, for a leg of this reach, m: on a small one
/// millimetres, on a large one as many of them in all.
double grain(const LegKinematics& leg) {
  constexpr double kSmallLeg = 0.25;  // m, height of what the bundled five-bars reach, and more
  const TargetBox bounds = reach_bounds(leg);
  return std::max(1.0, (bounds.max - bounds.min).z() / kSmallLeg);
}

}  // namespace

WorkspaceSample sample_target(const LegKinematics& leg, const Vector3& target, LegBranch branch) noexcept {
  const LegInverse solution = leg.inverse(target, branch);
  return {solution.status, leg.margins(solution.posture)};
}

bool is_safe(const WorkspaceSample& sample, const RequiredMargins& required) noexcept {
  return sample.status == IkStatus::kOk && sample.margins.joint_limit >= required.joint_limit &&
         sample.margins.serial >= required.serial && sample.margins.parallel >= required.parallel;
}

bool is_safe(const LegKinematics& leg, const Vector3& target, LegBranch branch,
             const RequiredMargins& required) noexcept {
  return is_safe(sample_target(leg, target, branch), required);
}

Vector3 WorkspaceMap::target(int ix, int iy, int iz) const {
  const Vector3 fraction(double(ix) / (count[0] - 1), double(iy) / (count[1] - 1),
                         double(iz) / (count[2] - 1));
  return box.min + fraction.cwiseProduct(box.max - box.min);
}

const WorkspaceSample& WorkspaceMap::at(int ix, int iy, int iz) const {
  return samples[(static_cast<std::size_t>(iz) * static_cast<std::size_t>(count[1]) +
                  static_cast<std::size_t>(iy)) *
                     static_cast<std::size_t>(count[0]) +
                 static_cast<std::size_t>(ix)];
}

double WorkspaceMap::reachable_fraction() const {
  const auto reachable =
      std::count_if(samples.begin(), samples.end(), [](const auto& s) { return s.status == IkStatus::kOk; });
  return static_cast<double>(reachable) / static_cast<double>(samples.size());
}

TargetBox reach_bounds(const LegKinematics& leg) {
  if (const auto* g = leg.as<FiveBarGeometry>()) {
    const double reach_a = largest_reach(g->a), reach_b = largest_reach(g->b);
    const std::array<double, 2> x{g->b.shoulder_x - reach_b, g->a.shoulder_x + reach_a};
    const double reach = std::min(reach_a, reach_b);
    if (!g->has_tilt) return {{x[0], 0, -reach}, {x[1], 0, 0}};
    return around(*g, x, reach);
  }
  if (const auto* g = leg.as<SerialLegGeometry>()) {
    const double reach = largest_reach(g->chain);
    TargetBox box = around(*g, {-reach, reach}, reach);
    if (!g->has_abduction) box = {{-reach, 0, -reach}, {reach, 0, 0}};
    return box;
  }
  if (const auto* g = leg.as<ClosedChainGeometry>()) {
    const Vector3 all = Vector3::Constant(g->chain.reach());
    TargetBox box{g->chain.origin(g->home, 0) - g->p_BL - all, g->chain.origin(g->home, 0) - g->p_BL + all};
    box.max.z() = std::min(box.max.z(), 0.0);
    return box;
  }
  // Any axes: no farther than all links in one line, from the first joint.
  const auto& g = *leg.as<LeastSquaresLegGeometry>();
  double reach = g.p_foot.norm();
  for (int i = 1; i < g.count; ++i) reach += g.links[static_cast<std::size_t>(i)].p.norm();
  const Vector3 centre = g.links[0].p, all = Vector3::Constant(reach);
  TargetBox box{centre - all, centre + all};
  box.max.z() = std::min(box.max.z(), 0.0);
  return box;
}

WorkspaceMap sample_workspace(const LegKinematics& leg, LegBranch branch, const TargetBox& box,
                              const std::array<int, 3>& count) {
  constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    const int n = count[static_cast<std::size_t>(axis)];
    const char* element = kAxes[static_cast<std::size_t>(axis)];
    if (n < 2) throw ConfigError("workspace", element, "at least 2 samples", fmt::format("{}", n));
    if (!std::isfinite(box.min[axis]) || !std::isfinite(box.max[axis]) || box.min[axis] > box.max[axis]) {
      throw ConfigError("workspace", element, "a finite interval, lower end first",
                        fmt::format("{:g} to {:g} m", box.min[axis], box.max[axis]));
    }
  }
  const double samples = 1.0 * count[0] * count[1] * count[2];
  if (samples > static_cast<double>(kMaxWorkspaceSamples)) {
    throw ConfigError("workspace", "samples", fmt::format("at most {} together", kMaxWorkspaceSamples),
                      fmt::format("{} x {} x {}", count[0], count[1], count[2]));
  }
  WorkspaceMap map{box, count, {}};
  map.samples.reserve(static_cast<std::size_t>(samples));
  for (int iz = 0; iz < count[2]; ++iz) {
    for (int iy = 0; iy < count[1]; ++iy) {
      for (int ix = 0; ix < count[0]; ++ix)
        map.samples.push_back(sample_target(leg, map.target(ix, iy, iz), branch));
    }
  }
  return map;
}

double safe_distance(const LegKinematics& leg, const Vector3& start, const Vector3& direction,
                     LegBranch branch, const RequiredMargins& required) noexcept {
  const auto safe_at = [&](double distance) {
    return is_safe(leg, start + distance * direction, branch, required);
  };
  if (!safe_at(0)) return 0;
  const double walk = grain(leg) * kWalk;
  double safe = 0, unsafe = walk;
  // Terminates: the reachable set is bounded, and so is a zero direction by the count.
  const TargetBox bounds = reach_bounds(leg);
  const int most = static_cast<int>((bounds.max - bounds.min).norm() / walk) + 1;
  for (int i = 0; i < most && safe_at(unsafe); ++i) {
    safe = unsafe;
    unsafe += walk;
  }
  while (unsafe - safe > kResolution) {
    const double middle = (safe + unsafe) / 2;
    (safe_at(middle) ? safe : unsafe) = middle;
  }
  return safe;
}

TargetBox safe_box(const LegKinematics& leg, const Vector3& centre, LegBranch branch,
                   const RequiredMargins& required) {
  TargetBox box{centre, centre};
  const auto safe = [&](const Vector3& target) { return is_safe(leg, target, branch, required); };
  if (!safe(centre)) return box;
  const double grow = grain(leg) * kGrow, spacing = grain(leg) * kSpacing;
  bool grew = true;
  while (grew) {
    grew = false;
    for (int axis = 0; axis < 3; ++axis) {
      for (Vector3* corner : {&box.min, &box.max}) {
        const double at = (*corner)[axis] + (corner == &box.max ? grow : -grow);
        if (!face_is_safe(box, axis, at, spacing, safe)) continue;
        (*corner)[axis] = at;
        grew = true;
      }
    }
  }
  return box;
}

}  // namespace crossgait
