#include "ik/five_bar.h"

#include <algorithm>
#include <cmath>

namespace crossgait {
namespace {

/// Depth above which the chain cannot fold, at x.
double fold_depth(const TwoLinkChain& c, double x) {
  const double r = smallest_reach(c), dx = x - c.shoulder_x;
  return std::sqrt(std::max(0.0, r * r - dx * dx));
}

bool within_reach(const TwoLinkChain& c, const Vector2& p) {
  const double dx = p.x() - c.shoulder_x, r = largest_reach(c);
  return dx * dx + p.y() * p.y() <= r * r;
}

/// Nearest point of the disc around the shoulder.
Vector2 project_to_reach(const TwoLinkChain& c, const Vector2& p) {
  const Vector2 shoulder(c.shoulder_x, 0), d = p - shoulder;
  return shoulder + d * (largest_reach(c) / d.norm());
}

/// Nearest point to `p` of the discs' intersection. Both centres lie at depth 0, so if `p` is not above it,
/// neither is the result.
Vector2 project_to_both_reaches(const FiveBarGeometry& g, const Vector2& p) {
  // A projection onto one disc that lies in the other is the nearest point of the intersection; otherwise it
  // is where the circles cross. Tolerance: the corner belongs to both up to rounding.
  for (const auto& [to, other] : {std::pair(&g.a, &g.b), std::pair(&g.b, &g.a)}) {
    if (within_reach(*to, p)) continue;
    Vector2 candidate = project_to_reach(*to, p);
    if (within_reach(*other, candidate)) return candidate;
  }
  const double ra = largest_reach(g.a), rb = largest_reach(g.b), base = g.base_distance();
  // Shoulders on one axis: one disc lies in the other, whatever rounding said above.
  if (base == 0) return project_to_reach(ra < rb ? g.a : g.b, p);
  const double along = (ra * ra - rb * rb + base * base) / (2 * base);
  return {g.a.shoulder_x + along, std::sqrt(std::max(0.0, ra * ra - along * along))};
}

/// Point of the neutral posture for requests that make no sense: below the shoulders, well inside the
/// workspace.
double neutral_depth(const FiveBarGeometry& g) {
  constexpr double kFraction = 0.7;
  return kFraction * std::min(largest_reach(g.a), largest_reach(g.b));
}

}  // namespace

IkStatus clamp_to_workspace(const FiveBarGeometry& g, Vector2& p) noexcept {
  IkStatus status = IkStatus::kOk;
  if (p.y() < std::max(smallest_reach(g.a), smallest_reach(g.b))) {
    const double depth = std::max(fold_depth(g.a, p.x()), fold_depth(g.b, p.x()));
    if (p.y() < depth) {
      p.y() = depth;
      status = IkStatus::kClampedTooNear;
    }
  }
  if (!within_reach(g.a, p) || !within_reach(g.b, p)) {
    p = project_to_both_reaches(g, p);
    status = IkStatus::kClampedTooFar;
  }
  return status;
}

FiveBarSolution solve_five_bar(const FiveBarGeometry& g, double x, double depth, WorkingMode mode) noexcept {
  const bool finite = std::isfinite(x) && std::isfinite(depth);
  Vector2 p = finite ? Vector2(x, depth) : Vector2(0, neutral_depth(g));
  const IkStatus clamped = clamp_to_workspace(g, p);
  const ElbowSigns signs = elbow_signs(mode);
  return {finite ? clamped : IkStatus::kInvalidTarget, plane_angles(place_links(g.a, p, signs.a), signs.a),
          plane_angles(place_links(g.b, p, signs.b), signs.b)};
}

FiveBarClosure close_five_bar(const FiveBarGeometry& g, const Vector2& upper_a, const Vector2& upper_b,
                              WorkingMode mode) noexcept {
  const Vector2 elbow_a = Vector2(g.a.shoulder_x, 0) + upper_a;
  const Vector2 elbow_b = Vector2(g.b.shoulder_x, 0) + upper_b;
  const Vector2 d = elbow_b - elbow_a;
  const double r2 = d.squaredNorm();
  FiveBarClosure result;
  result.foot = (elbow_a + elbow_b) / 2;
  if (r2 > 0) {
    const double along = (r2 + g.a.lower * g.a.lower - g.b.lower * g.b.lower) / (2 * r2);
    const double across2 = g.a.lower * g.a.lower / r2 - along * along;
    result.closed = across2 >= 0;
    const double across = std::sqrt(std::max(0.0, across2));
    const ElbowSigns signs = elbow_signs(mode);
    int best = -1;
    for (const double side : {1.0, -1.0}) {
      const Vector2 foot = elbow_a + along * d + side * across * Vector2(-d.y(), d.x());
      const int matches =
          (signs.a * cross(upper_a, foot - elbow_a) >= 0) + (signs.b * cross(upper_b, foot - elbow_b) >= 0);
      if (matches > best || (matches == best && foot.y() > result.foot.y())) {
        best = matches;
        result.foot = foot;
      }
    }
  }
  result.a = {upper_a, result.foot - elbow_a};
  result.b = {upper_b, result.foot - elbow_b};
  return result;
}

}  // namespace crossgait
