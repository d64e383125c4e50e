// Loop closures and coupled joints: what is held together by MuJoCo's soft constraint.
#pragma once

#include <vector>

#include "dynamics.h"

#include "crossgait/physics/engine/world_spec.h"

namespace crossgait::skeleton {

/// Solves the law that RobotDescription::loop_softness and JointCoupling::softness speak of (MuJoCo 2.2
/// manual, "Computation > Constraint model"). With the violation r and its Jacobian J an impulse y is given
/// such that
///     J v' + R y = J v - h (B J v + K imp r),
/// R = (1 - imp) / imp times the inverse weight of the two bodies or joints, B = 2 / (imp_max t_c) and
/// K = 1 / (imp_max t_c d_r)^2. Nothing bounds y, so that it can be eliminated: J' R^-1 J is added to the
/// inertia, and J' R^-1 of the right-hand side to the momentum.
class Loops {
 public:
  /// @param spec  has to outlive it
  explicit Loops(const WorldSpec& spec);

  /// Adds the loops and couplings to A v' = b. @param q  joint angles before the step, rad
  void add(const Dynamics& dynamics, const JointVector& q, DofMatrix& A, DofVector& b) const noexcept;

 private:
  struct Law {
    Softness soft;
    double stiffness, damping;  // K, 1/s^2, and B, 1/s
    double inverse_weight;      // 1/kg, 1/(kg m^2)

    double impedance(double violation) const noexcept;
  };
  Law law_of(const Softness& soft, double inverse_weight) const;

  const WorldSpec& spec_;
  std::vector<Law> of_loops_, of_couplings_;
};

}  // namespace crossgait::skeleton
