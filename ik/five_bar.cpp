#include "crossgait/ik/five_bar.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace crossgait {
namespace {

/// A chain of equal links could fold to a point, where its direction is undefined: keep this far away, m.
constexpr double kSmallestFold = 1e-6;

double largest_reach(const FiveBarChain& c) { return c.upper + c.lower; }
double smallest_reach(const FiveBarChain& c) { return std::max(std::abs(c.upper - c.lower), kSmallestFold); }

/// Depth above which the chain cannot fold, at x.
double fold_depth(const FiveBarChain& c, double x) {
  const double r = smallest_reach(c), dx = x - c.shoulder_x;
  return std::sqrt(std::max(0.0, r * r - dx * dx));
}

bool within_reach(const FiveBarChain& c, const Vector2& p) {
  const double dx = p.x() - c.shoulder_x, r = largest_reach(c);
  return dx * dx + p.y() * p.y() <= r * r;
}

/// Nearest point of the disc around the shoulder.
Vector2 project_to_reach(const FiveBarChain& c, const Vector2& p) {
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
  const double along = (ra * ra - rb * rb + base * base) / (2 * base);
  return {g.a.shoulder_x + along, std::sqrt(std::max(0.0, ra * ra - along * along))};
}

/// Point of the neutral posture for requests that make no sense: below the shoulders, well inside the
/// workspace.
double neutral_depth(const FiveBarGeometry& g) {
  constexpr double kFraction = 0.7;
  return kFraction * std::min(largest_reach(g.a), largest_reach(g.b));
}

TwoLinkSolution angles(const ChainLinks& links, double elbow_sign) {
  // A straight chain's tiny cross product may have either sign: give the elbow the one asked for.
  const double bend = std::atan2(std::abs(cross(links.upper, links.lower)), links.upper.dot(links.lower));
  return {IkStatus::kOk, std::atan2(links.upper.y(), links.upper.x()), elbow_sign * bend};
}

}  // namespace

std::string_view name(IkStatus status) noexcept {
  constexpr std::array<std::string_view, 5> kNames{"ok", "clamped_too_far", "clamped_too_near",
                                                   "clamped_joint_limit", "invalid_target"};
  return kNames[static_cast<std::size_t>(status)];
}

ChainLinks place_links(const FiveBarChain& chain, const Vector2& p, double elbow_sign) noexcept {
  const Vector2 d(p.x() - chain.shoulder_x, p.y());
  const double r2 = d.squaredNorm(), upper2 = chain.upper * chain.upper;
  // The elbow in units of d: `along` it, and `across` it towards smaller plane angles.
  const double along = (r2 + upper2 - chain.lower * chain.lower) / (2 * r2);
  const double across = std::sqrt(std::max(0.0, upper2 / r2 - along * along));
  const Vector2 upper = along * d + elbow_sign * across * Vector2(d.y(), -d.x());
  return {upper, d - upper};
}

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

TwoLinkSolution solve_two_link(double upper, double lower, double x, double depth,
                               double elbow_sign) noexcept {
  FiveBarChain chain;
  chain.upper = upper;
  chain.lower = lower;
  const double far = largest_reach(chain), near = smallest_reach(chain);
  if (!std::isfinite(x) || !std::isfinite(depth)) {
    TwoLinkSolution neutral = angles(place_links(chain, {0, (near + far) / 2}, elbow_sign), elbow_sign);
    neutral.status = IkStatus::kInvalidTarget;
    return neutral;
  }
  const double r = std::hypot(x, depth);
  const double reach = std::clamp(r, near, far);
  // The ray of the origin itself is undefined: straight down.
  const Vector2 p = r > 0 ? Vector2(x / r * reach, depth / r * reach) : Vector2(0, reach);
  TwoLinkSolution solution = angles(place_links(chain, p, elbow_sign), elbow_sign);
  if (r > far) solution.status = IkStatus::kClampedTooFar;
  if (r < near) solution.status = IkStatus::kClampedTooNear;
  return solution;
}

FiveBarSolution solve_five_bar(const FiveBarGeometry& g, double x, double depth, WorkingMode mode) noexcept {
  const bool finite = std::isfinite(x) && std::isfinite(depth);
  Vector2 p = finite ? Vector2(x, depth) : Vector2(0, neutral_depth(g));
  const IkStatus clamped = clamp_to_workspace(g, p);
  const ElbowSigns signs = elbow_signs(mode);
  return {finite ? clamped : IkStatus::kInvalidTarget, angles(place_links(g.a, p, signs.a), signs.a),
          angles(place_links(g.b, p, signs.b), signs.b)};
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
