#include "loops.h"

#include <algorithm>
#include <cmath>

#include "crossgait/physics/robot/multibody.h"

namespace crossgait::skeleton {

Loops::Loops(const WorldSpec& spec) : spec_(spec) {
  const Softness& soft = spec.robot->loop_softness;
  const double time_constant = std::max(soft.time_constant, 2 * spec.physics_dt);
  stiffness_ = 1 / std::pow(soft.impedance_max * time_constant * soft.damping_ratio, 2);
  damping_ = 2 / (soft.impedance_max * time_constant);
  const std::vector<double> weights = translational_inverse_weights(*spec.robot, spec.fixed_base);
  for (const LoopClosure& loop : spec.robot->loops)
    inverse_weights_.push_back(weights[static_cast<std::size_t>(loop.body_a)] +
                               weights[static_cast<std::size_t>(loop.body_b)]);
}

// Rises from its least to its greatest value over impedance_width, as two powers that meet at the midpoint.
double Loops::impedance(double gap) const noexcept {
  const Softness& soft = spec_.robot->loop_softness;
  const double x = std::min(gap / soft.impedance_width, 1.0);
  const double p = soft.impedance_power, middle = soft.impedance_midpoint;
  const double y = x <= middle ? std::pow(x, p) / std::pow(middle, p - 1)
                               : 1 - std::pow(1 - x, p) / std::pow(1 - middle, p - 1);
  return soft.impedance_min + y * (soft.impedance_max - soft.impedance_min);
}

void Loops::add(const Dynamics& dynamics, DofMatrix& A, DofVector& b) const noexcept {
  for (std::size_t i = 0; i < inverse_weights_.size(); ++i) {
    const LoopClosure& loop = spec_.robot->loops[i];
    const Vector3 p_WA = dynamics.pose(loop.body_a) * loop.p_AP,
                  p_WB = dynamics.pose(loop.body_b) * loop.p_BP;
    const PointJacobian J = dynamics.jacobian(loop.body_a, p_WA) - dynamics.jacobian(loop.body_b, p_WB);
    const Vector3 gap = p_WA - p_WB, speed = J * dynamics.velocity();
    const double imp = std::clamp(impedance(gap.norm()), 1e-4, 0.9999);  // MuJoCo's bounds
    const double R = (1 - imp) / imp * inverse_weights_[i];
    if (!(R > 0)) continue;  // neither body can move
    const Vector3 wanted = speed - spec_.physics_dt * (damping_ * speed + stiffness_ * imp * gap);
    A.noalias() += J.transpose() * J / R;
    b.noalias() += J.transpose() * wanted / R;
  }
}

}  // namespace crossgait::skeleton
