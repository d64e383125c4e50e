#include "loops.h"

#include <algorithm>
#include <cmath>

#include "crossgait/physics/robot/multibody.h"

namespace crossgait::skeleton {

Loops::Loops(const WorldSpec& spec) : spec_(spec) {
  const RobotDescription& robot = *spec.robot;
  const std::vector<double> bodies = translational_inverse_weights(robot, spec.fixed_base);
  for (const LoopClosure& loop : robot.loops)
    of_loops_.push_back(law_of(robot.loop_softness, bodies[static_cast<std::size_t>(loop.body_a)] +
                                                        bodies[static_cast<std::size_t>(loop.body_b)]));
  const JointVector joints = joint_inverse_weights(robot, spec.fixed_base);
  for (const JointCoupling& coupling : robot.couplings)
    of_couplings_.push_back(law_of(coupling.softness, joints[coupling.follower] + joints[coupling.leader]));
}

Loops::Law Loops::law_of(const Softness& soft, double inverse_weight) const {
  const double time_constant = time_constant_in_steps(soft.time_constant, spec_.physics_dt);
  return {soft, 1 / std::pow(soft.impedance_max * time_constant * soft.damping_ratio, 2),
          2 / (soft.impedance_max * time_constant), inverse_weight};
}

// Rises from its least to its greatest value over impedance_width, as two powers that meet at the midpoint;
// within MuJoCo's bounds.
double Loops::Law::impedance(double violation) const noexcept {
  const double x = std::min(std::abs(violation) / soft.impedance_width, 1.0);
  const double p = soft.impedance_power, middle = soft.impedance_midpoint;
  const double y = x <= middle ? std::pow(x, p) / std::pow(middle, p - 1)
                               : 1 - std::pow(1 - x, p) / std::pow(1 - middle, p - 1);
  return std::clamp(soft.impedance_min + y * (soft.impedance_max - soft.impedance_min), 1e-4, 0.9999);
}

void Loops::add(const Dynamics& dynamics, const JointVector& q, DofMatrix& A, DofVector& b) const noexcept {
  const double h = spec_.physics_dt;
  for (std::size_t i = 0; i < of_loops_.size(); ++i) {
    const LoopClosure& loop = spec_.robot->loops[i];
    const Law& law = of_loops_[i];
    const Vector3 p_WA = dynamics.pose(loop.body_a) * loop.p_AP,
                  p_WB = dynamics.pose(loop.body_b) * loop.p_BP;
    const PointJacobian J = dynamics.jacobian(loop.body_a, p_WA) - dynamics.jacobian(loop.body_b, p_WB);
    const Vector3 gap = p_WA - p_WB, speed = J * dynamics.velocity();
    const double imp = law.impedance(gap.norm());
    const double R = (1 - imp) / imp * law.inverse_weight;
    if (!(R > 0)) continue;  // neither body can move
    const Vector3 wanted = speed - h * (law.damping * speed + law.stiffness * imp * gap);
    A.noalias() += J.transpose() * J / R;
    b.noalias() += J.transpose() * wanted / R;
  }
  for (std::size_t i = 0; i < of_couplings_.size(); ++i) {
    const JointCoupling& coupling = spec_.robot->couplings[i];
    const Law& law = of_couplings_[i];
    const Eigen::Index to = 6 + coupling.follower, from = 6 + coupling.leader;
    const double slope = coupling.slope_at(q[coupling.leader]),
                 violation = q[coupling.follower] - coupling.follower_at(q[coupling.leader]),
                 speed = dynamics.velocity()[to] - slope * dynamics.velocity()[from];
    const double imp = law.impedance(violation), R = (1 - imp) / imp * law.inverse_weight;
    const double wanted = speed - h * (law.damping * speed + law.stiffness * imp * violation);
    A(to, to) += 1 / R;
    A(from, from) += slope * slope / R;
    A(to, from) -= slope / R;
    A(from, to) -= slope / R;
    b[to] += wanted / R;
    b[from] -= slope * wanted / R;
  }
}

}  // namespace crossgait::skeleton
