#include "crossgait/ik/workspace.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "crossgait/physics/error.h"

namespace crossgait {
namespace {

constexpr double kWalk = 5e-4;        // m, step of safe_distance
constexpr double kResolution = 1e-6;  // m, its bisection
constexpr double kGrow = 1e-3;        // m, by which a face of safe_box moves
constexpr double kSpacing = 2e-3;     // m, between targets on a face

int samples_along(double length) { return 2 + static_cast<int>(length / kSpacing); }

/// Whether every target on the face of `box` at `at` across `axis` is safe.
template <typename Safe>
bool face_is_safe(const TargetBox& box, int axis, double at, const Safe& safe) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const int nu = samples_along(box.max[u] - box.min[u]), nv = samples_along(box.max[v] - box.min[v]);
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

}  // namespace

WorkspaceSample sample_target(const FiveBarGeometry& g, const Vector3& target, WorkingMode mode) noexcept {
  const LegSolution solution = solve_leg(g, target, mode);
  return {solution.status, leg_margins(g, solution.angles)};
}

bool is_safe(const WorkspaceSample& sample, const RequiredMargins& required) noexcept {
  return sample.status == IkStatus::kOk && sample.margins.joint_limit >= required.joint_limit &&
         sample.margins.serial >= required.serial && sample.margins.parallel >= required.parallel;
}

bool is_safe(const FiveBarGeometry& g, const Vector3& target, WorkingMode mode,
             const RequiredMargins& required) noexcept {
  return is_safe(sample_target(g, target, mode), required);
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

TargetBox reach_bounds(const FiveBarGeometry& g) {
  const double reach_a = g.a.upper + g.a.lower, reach_b = g.b.upper + g.b.lower;
  const double down = std::min(reach_a, reach_b), a = g.axis_to_plane_out, b = g.axis_to_shoulder_down;
  const double around = std::hypot(a, down + b);  // of the foot about the tilt axis
  const double inward = g.side * (-around - a), outward = g.side * (around - a);
  return {{g.b.shoulder_x - reach_b, std::min(inward, outward), b - around},
          {g.a.shoulder_x + reach_a, std::max(inward, outward), 0}};
}

WorkspaceMap sample_workspace(const FiveBarGeometry& g, WorkingMode mode, const TargetBox& box,
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
  WorkspaceMap map{box, count, {}};
  map.samples.reserve(static_cast<std::size_t>(count[0]) * static_cast<std::size_t>(count[1]) *
                      static_cast<std::size_t>(count[2]));
  for (int iz = 0; iz < count[2]; ++iz) {
    for (int iy = 0; iy < count[1]; ++iy) {
      for (int ix = 0; ix < count[0]; ++ix)
        map.samples.push_back(sample_target(g, map.target(ix, iy, iz), mode));
    }
  }
  return map;
}

double safe_distance(const FiveBarGeometry& g, const Vector3& start, const Vector3& direction,
                     WorkingMode mode, const RequiredMargins& required) noexcept {
  const auto safe_at = [&](double distance) {
    return is_safe(g, start + distance * direction, mode, required);
  };
  if (!safe_at(0)) return 0;
  double safe = 0, unsafe = kWalk;
  // Terminates: the reachable set is bounded, and so is a zero direction by the count.
  const TargetBox bounds = reach_bounds(g);
  const int most = static_cast<int>((bounds.max - bounds.min).norm() / kWalk) + 1;
  for (int i = 0; i < most && safe_at(unsafe); ++i) {
    safe = unsafe;
    unsafe += kWalk;
  }
  while (unsafe - safe > kResolution) {
    const double middle = (safe + unsafe) / 2;
    (safe_at(middle) ? safe : unsafe) = middle;
  }
  return safe;
}

TargetBox safe_box(const FiveBarGeometry& g, const Vector3& centre, WorkingMode mode,
                   const RequiredMargins& required) {
  TargetBox box{centre, centre};
  const auto safe = [&](const Vector3& target) { return is_safe(g, target, mode, required); };
  if (!safe(centre)) return box;
  bool grew = true;
  while (grew) {
    grew = false;
    for (int axis = 0; axis < 3; ++axis) {
      for (Vector3* corner : {&box.min, &box.max}) {
        const double at = (*corner)[axis] + (corner == &box.max ? kGrow : -kGrow);
        if (!face_is_safe(box, axis, at, safe)) continue;
        (*corner)[axis] = at;
        grew = true;
      }
    }
  }
  return box;
}

}  // namespace crossgait
