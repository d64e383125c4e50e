#include "ik/two_link_chain.h"

namespace crossgait {

ChainLinks place_links(const TwoLinkChain& chain, const Vector2& p, double elbow_sign) noexcept {
  const Vector2 d(p.x() - chain.shoulder_x, p.y());
  const double r2 = d.squaredNorm(), upper2 = chain.upper * chain.upper;
  // The elbow in units of d: `along` it, and `across` it towards smaller plane angles.
  const double along = (r2 + upper2 - chain.lower * chain.lower) / (2 * r2);
  const double across = std::sqrt(std::max(0.0, upper2 / r2 - along * along));
  const Vector2 upper = along * d + elbow_sign * across * Vector2(d.y(), -d.x());
  return {upper, d - upper};
}

TwoLinkSolution plane_angles(const ChainLinks& links, double elbow_sign) noexcept {
  // A straight chain's tiny cross product may have either sign: give the elbow the one asked for.
  const double bend = std::atan2(std::abs(cross(links.upper, links.lower)), links.upper.dot(links.lower));
  return {IkStatus::kOk, std::atan2(links.upper.y(), links.upper.x()), elbow_sign * bend};
}

IkStatus clamp_to_reach(const TwoLinkChain& chain, Vector2& d) noexcept {
  const double far = largest_reach(chain), near = smallest_reach(chain);
  const double r = std::hypot(d.x(), d.y());
  const double reach = std::clamp(r, near, far);
  d = r > 0 ? Vector2(d.x() / r * reach, d.y() / r * reach) : Vector2(0, reach);
  if (r > far) return IkStatus::kClampedTooFar;
  return r < near ? IkStatus::kClampedTooNear : IkStatus::kOk;
}

TwoLinkSolution solve_two_link(double upper, double lower, double x, double depth,
                               double elbow_sign) noexcept {
  TwoLinkChain chain;
  chain.upper = upper;
  chain.lower = lower;
  if (!std::isfinite(x) || !std::isfinite(depth)) {
    const double middle = (smallest_reach(chain) + largest_reach(chain)) / 2;
    TwoLinkSolution neutral = plane_angles(place_links(chain, {0, middle}, elbow_sign), elbow_sign);
    neutral.status = IkStatus::kInvalidTarget;
    return neutral;
  }
  Vector2 p(x, depth);
  const IkStatus status = clamp_to_reach(chain, p);
  TwoLinkSolution solution = plane_angles(place_links(chain, p, elbow_sign), elbow_sign);
  solution.status = status;
  return solution;
}

}  // namespace crossgait
