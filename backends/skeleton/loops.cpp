#include "loops.h"

#include "crossgait/physics/robot/multibody.h"

namespace crossgait::skeleton {

Loops::Loops(const WorldSpec& spec) : spec_(spec) {
  const RobotDescription& robot = *spec.robot;
  const std::vector<double> bodies = translational_inverse_weights(robot, spec.fixed_base);
  for (const LoopClosure& loop : robot.loops)
    of_loops_.push_back(
        {SoftLaw(robot.loop_softness, spec.physics_dt),
         bodies[static_cast<std::size_t>(loop.body_a)] + bodies[static_cast<std::size_t>(loop.body_b)]});
  const JointVector joints = joint_inverse_weights(robot, spec.fixed_base);
  for (const JointCoupling& coupling : robot.couplings)
    of_couplings_.push_back(
        {SoftLaw(coupling.softness, spec.physics_dt), joints[coupling.follower] + joints[coupling.leader]});
}

void Loops::add(const Dynamics& dynamics, const JointVector& q, DofMatrix& A, DofVector& b) const noexcept {
  for (std::size_t i = 0; i < of_loops_.size(); ++i) {
    const LoopClosure& loop = spec_.robot->loops[i];
    const auto& [law, inverse_weight] = of_loops_[i];
    const Vector3 p_WA = dynamics.pose(loop.body_a) * loop.p_AP,
                  p_WB = dynamics.pose(loop.body_b) * loop.p_BP;
    const PointJacobian J = dynamics.jacobian(loop.body_a, p_WA) - dynamics.jacobian(loop.body_b, p_WB);
    const Vector3 gap = p_WA - p_WB, speed = J * dynamics.velocity();
    const double imp = law.impedance(gap.norm());
    const double R = SoftLaw::regularization(imp, inverse_weight);
    if (!(R > 0)) continue;  // neither body can move
    const Vector3 wanted = law.target_velocity(speed, imp, gap);
    A.noalias() += J.transpose() * J / R;
    b.noalias() += J.transpose() * wanted / R;
  }
  for (std::size_t i = 0; i < of_couplings_.size(); ++i) {
    const JointCoupling& coupling = spec_.robot->couplings[i];
    const auto& [law, inverse_weight] = of_couplings_[i];
    const Eigen::Index to = 6 + coupling.follower, from = 6 + coupling.leader;
    const double slope = coupling.slope_at(q[coupling.leader]),
                 violation = q[coupling.follower] - coupling.follower_at(q[coupling.leader]),
                 speed = dynamics.velocity()[to] - slope * dynamics.velocity()[from];
    const double imp = law.impedance(violation), R = SoftLaw::regularization(imp, inverse_weight);
    const double wanted = law.target_velocity(speed, imp, violation);
    A(to, to) += 1 / R;
    A(from, from) += slope * slope / R;
    A(to, from) -= slope / R;
    A(from, to) -= slope / R;
    b[to] += wanted / R;
    b[from] -= slope * wanted / R;
  }
}

}  // namespace crossgait::skeleton
