#include "motion/servo_compensation.h"

#include <algorithm>
#include <cmath>

namespace crossgait {
namespace {

// Force (x, depth) in the leg's plane that drags the passive elbow of one chain along.
Vector2 elbow_drag(const TwoLinkChain& chain, const ChainLinks& links, const Vector2& velocity,
                   const JointDrag& elbow) noexcept {
  const Vector2 r = links.upper + links.lower;
  // Near a straight or folded elbow its rate grows without bound; a twentieth of the largest value is far
  // beyond use.
  const double smallest = 0.05 * chain.upper * chain.lower;
  const double c = std::max(std::abs(cross(links.upper, links.lower)), smallest);
  const double along = r.dot(velocity);
  return (elbow.damping * along / (c * c) + elbow.dry(along / c) / c) * r;
}

}  // namespace

LegArray<double> load_shares(const LegArray<Vector3>& feet, double depth) noexcept {
  double lowest = feet[kLegs.front()].z(), sum = 0;
  for (const Leg leg : kLegs) lowest = std::min(lowest, feet[leg].z());
  LegArray<double> shares{};
  for (const Leg leg : kLegs) {
    const double u = std::clamp(1 - (feet[leg].z() - lowest) / depth, 0.0, 1.0);
    sum += shares[leg] = u * u * (3 - 2 * u);
  }
  for (double& share : shares) share /= sum;  // the lowest foot's is 1
  return shares;
}

Vector3 elbow_drag_force(const FiveBarGeometry& g, const PlacedLeg& leg, const Vector3& velocity,
                         const JointDrag& elbow) noexcept {
  // Depth in the leg's plane and its gradient along y and down: D^2 = Y^2 + Z^2 - a^2 (ik/tilt_mount.h).
  double D_y = 0, D_down = 1;
  if (g.has_tilt) {
    const double a = g.axis_to_plane_out, D = std::max(leg.foot.y() + g.axis_to_shoulder_down, 1e-4);
    D_y = g.side * (a * leg.c + D * leg.s) / D;
    D_down = (D * leg.c - a * leg.s) / D;
  }
  const Vector2 rate(velocity.x(), D_y * velocity.y() - D_down * velocity.z());
  const Vector2 drag = elbow_drag(g.a, leg.a, rate, elbow) + elbow_drag(g.b, leg.b, rate, elbow);
  const Vector3 force(drag.x(), D_y * drag.y(), -D_down * drag.y());
  return force.allFinite() ? force : Vector3(Vector3::Zero());
}

}  // namespace crossgait
