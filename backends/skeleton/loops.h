// Loop closures and coupled joints: what is held together by MuJoCo's soft constraint.
#pragma once

#include <vector>

#include "dynamics.h"

#include "crossgait/physics/engine/soft_law.h"
#include "crossgait/physics/engine/world_spec.h"

namespace crossgait::skeleton {

/// Solves the law that RobotDescription::loop_softness and JointCoupling::softness speak of (SoftLaw): an
/// impulse y is given such that  J v' + R y = J v - h (B J v + K imp r).  Nothing bounds y, so that it can be
/// eliminated: J' R^-1 J is added to the inertia, and J' R^-1 of the right-hand side to the momentum.
class Loops {
 public:
  /// @param spec  has to outlive it
  explicit Loops(const WorldSpec& spec);

  /// Adds the loops and couplings to A v' = b. @param q  joint angles before the step, rad
  void add(const Dynamics& dynamics, const JointVector& q, DofMatrix& A, DofVector& b) const noexcept;

 private:
  struct SoftRow {
    SoftLaw law;
    double inverse_weight;  // of both bodies, 1/kg, or joints, 1/(kg m^2)
  };

  const WorldSpec& spec_;
  std::vector<SoftRow> of_loops_, of_couplings_;
};

}  // namespace crossgait::skeleton
