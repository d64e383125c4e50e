// What the contacts of a world carry, and how far they may give way.
#pragma once

#include <cmath>

#include "physics/engine/physics_backend.h"

namespace crossgait::conformance {

/// Computes how deep a soft contact with default softness sinks at rest under `force`, at most, m: MuJoCo's R
/// f = K imp r with impedance at its least. @param inverse_weight  1/kg
inline double sinking(double force, double inverse_weight) {
  const Softness soft;
  const double R = (1 - soft.impedance_min) / soft.impedance_min * inverse_weight;
  const double K = 1 / std::pow(soft.impedance_max * soft.time_constant * soft.damping_ratio, 2);
  return R * force / (K * soft.impedance_min);
}

/// Returns how fast what rests may be moved by the way in which an engine solves its law of contact, m/s. A
/// solver that stops after a few iterations, whether it has converged or not ("/temporal" in Laws::contact),
/// leaves a fifth of what gravity adds in a step of 1 ms.
double residual_speed(const EngineInfo& engine);

inline Vector3 total_force(const PhysicsBackend& world) {
  Vector3 sum = Vector3::Zero();
  for (const Contact& c : world.contacts()) sum += c.force;
  return sum;
}

}  // namespace crossgait::conformance
