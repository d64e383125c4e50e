// Loop closures: two points held together by MuJoCo's soft constraint.
#pragma once

#include <vector>

#include "dynamics.h"

#include "crossgait/physics/engine/world_spec.h"

namespace crossgait::skeleton {

/// Solves the law that RobotDescription::loop_softness speaks of (MuJoCo 2.2 manual, "Computation >
/// Constraint model"). With the gap r and its Jacobian J an impulse y is given such that
///     J v' + R y = J v - h (B J v + K imp r),
/// R = (1 - imp) / imp times the inverse weight of the two bodies, B = 2 / (imp_max t_c) and
/// K = 1 / (imp_max t_c d_r)^2. Nothing bounds y, so that it can be eliminated: J' R^-1 J is added to the
/// inertia, and J' R^-1 of the right-hand side to the momentum.
class Loops {
 public:
  /// @param spec  has to outlive it
  explicit Loops(const WorldSpec& spec);

  /// Adds the loops to A v' = b.
  void add(const Dynamics& dynamics, DofMatrix& A, DofVector& b) const noexcept;

 private:
  double impedance(double gap) const noexcept;

  const WorldSpec& spec_;
  double stiffness_, damping_;           // K, 1/s^2, and B, 1/s
  std::vector<double> inverse_weights_;  // one a loop, 1/kg
};

}  // namespace crossgait::skeleton
