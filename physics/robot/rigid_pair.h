// Mass properties of bodies that are fixed to each other.
#pragma once

#include "physics/robot/robot.h"

namespace crossgait {

/// Returns the inertia of both together, in one frame (parallel-axis theorem).
inline SpatialInertia combine(const SpatialInertia& a, const SpatialInertia& b) {
  if (a.mass == 0) return b;
  if (b.mass == 0) return a;
  SpatialInertia sum;
  sum.mass = a.mass + b.mass;
  sum.p_BC = (a.mass * a.p_BC + b.mass * b.p_BC) / sum.mass;
  for (const SpatialInertia* part : {&a, &b}) {
    const Vector3 d = part->p_BC - sum.p_BC;
    sum.I_C += part->I_C + part->mass * (d.squaredNorm() * Matrix3::Identity() - d * d.transpose());
  }
  return sum;
}

/// Returns mass properties in another frame. @param X_AB  of the frame they are in
inline SpatialInertia moved(const Pose& X_AB, const SpatialInertia& inertia) {
  const Matrix3 R = X_AB.linear();
  SpatialInertia result{inertia.mass, X_AB * inertia.p_BC, R * inertia.I_C * R.transpose()};
  result.I_C = 0.5 * (result.I_C + result.I_C.transpose()).eval();  // exactly symmetric despite rounding
  return result;
}

}  // namespace crossgait
