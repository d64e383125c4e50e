#include "backends/contact/joint_stage.h"

#include <Eigen/Cholesky>

#include "physics/core/error.h"
#include "physics/robot/multibody.h"

namespace crossgait::contact {

JointStage::JointStage(const WorldSpec& spec, const BodyKinematics& bodies)
    : inertia_(*spec.robot, spec.fixed_base, spec.physics_dt),
      bodies_(bodies),
      law_(spec.robot->loop_softness, spec.physics_dt),
      step_(spec.physics_dt) {
  const std::vector<double> weights = translational_inverse_weights(*spec.robot, spec.fixed_base);
  for (const LoopClosure& loop : spec.robot->loops) {
    const auto a = static_cast<std::size_t>(loop.body_a), b = static_cast<std::size_t>(loop.body_b);
    loops_.push_back({loop.body_a, loop.body_b, bodies.X_BC[a].inverse() * loop.p_AP,
                      bodies.X_BC[b].inverse() * loop.p_BP, weights[a] + weights[b]});
  }
  if (loops_.size() > kMaxLoops) {
    throw ConfigError("robot", "loops", "at most 16 loop closures", std::to_string(loops_.size()));
  }
  const JointVector joint_weights = joint_inverse_weights(*spec.robot, spec.fixed_base);
  for (const JointCoupling& coupling : spec.robot->couplings) {
    couplings_.push_back({coupling, SoftLaw(coupling.softness, spec.physics_dt),
                          joint_weights[coupling.follower] + joint_weights[coupling.leader]});
  }
  const Eigen::Index rows = static_cast<Eigen::Index>(3 * loops_.size() + couplings_.size());
  Y_.setZero(inertia_.dofs(), rows);
  P_.setZero(rows, inertia_.dofs());
  regularization_.setZero(rows);
  rhs_.setZero(rows);
  K_.setZero(rows, rows);
}

void JointStage::solve(const DofVector& before, const DofVector& free, const JointVector& angles,
                       const JointVector& torque) noexcept {
  solve_smooth(before, free, torque);
  if (row_count() == 0) return;

  assemble_loops(before);
  assemble_couplings(before, angles);
  K_.noalias() = Y_.transpose() * Y_;
  K_.diagonal() += regularization_;
  Eigen::LLT<Eigen::Ref<LoopMatrix>> cholesky(K_);
  P_ = Y_.transpose();
  cholesky.matrixL().solveInPlace(P_);
  cholesky.solveInPlace(rhs_);
  work_.noalias() = Y_ * rhs_;
  inertia_.finish_solve(work_);
  velocity_ += work_;
}

// (M0 + A)(v' - v) = M0 (v_free - v) + h tau: the engine's forward dynamics knows nothing of the armature A.
void JointStage::solve_smooth(const DofVector& before, const DofVector& free,
                              const JointVector& torque) noexcept {
  work_ = free - before;
  inertia_.multiply_bare(work_, velocity_);
  velocity_.tail(torque.size()) += step_ * torque;
  inertia_.half_solve(velocity_);
  inertia_.finish_solve(velocity_);
  velocity_ += before;
}

void JointStage::assemble_loops(const DofVector& before) noexcept {
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    const LoopPoints& loop = loops_[i];
    const Vector3 a = bodies_.point(loop.body_a, loop.p_A);
    const Vector3 b = bodies_.point(loop.body_b, loop.p_B);
    bodies_.point_jacobian(loop.body_a, a, J_a_);
    bodies_.point_jacobian(loop.body_b, b, J_b_);
    J_a_ -= J_b_;
    const Vector3 gap = a - b;
    const double imp = law_.impedance(gap.norm());  // MuJoCo takes the norm of the gap for all three rows
    for (int k = 0; k < 3; ++k) {
      const Eigen::Index row = 3 * static_cast<Eigen::Index>(i) + k;
      const double target = law_.target_velocity(J_a_.row(k).dot(before), imp, gap[k]);
      rhs_[row] = target - J_a_.row(k).dot(velocity_);
      regularization_[row] = SoftLaw::regularization(imp, loop.inverse_weight);
      work_ = J_a_.row(k).transpose();
      inertia_.half_solve(work_);
      Y_.col(row) = work_;
    }
  }
}

// As mjEQ_JOINT of MuJoCo (engine_core_constraint.c, mj_instantiateEqual; weights: mj_diagApprox).
void JointStage::assemble_couplings(const DofVector& before, const JointVector& angles) noexcept {
  for (std::size_t i = 0; i < couplings_.size(); ++i) {
    const auto& [coupling, law, inverse_weight] = couplings_[i];
    const Eigen::Index row = static_cast<Eigen::Index>(3 * loops_.size() + i);
    const double leader = angles[coupling.leader], slope = coupling.slope_at(leader);
    const double violation = angles[coupling.follower] - coupling.follower_at(leader);
    const Eigen::Index to = 6 + coupling.follower, from = 6 + coupling.leader;
    const double imp = law.impedance(violation);
    const double target = law.target_velocity(before[to] - slope * before[from], imp, violation);
    rhs_[row] = target - (velocity_[to] - slope * velocity_[from]);
    regularization_[row] = SoftLaw::regularization(imp, inverse_weight);
    work_.setZero();
    work_[to] = 1;
    work_[from] = -slope;
    inertia_.half_solve(work_);
    Y_.col(row) = work_;
  }
}

void JointStage::project(Eigen::Ref<DofVector> y) const noexcept {
  if (row_count() == 0) return;
  LoopVector response(P_.rows());
  response.noalias() = P_ * y;
  y.noalias() -= P_.transpose() * response;
}

void JointStage::scaled_loop_rows(Eigen::MatrixXd& E) const noexcept {
  E.noalias() = Y_ * regularization_.cwiseSqrt().cwiseInverse().asDiagonal();
}

std::vector<std::vector<int>> JointStage::coupled_dofs() const {
  std::vector<std::vector<int>> sets;
  for (int body = 0; body <= inertia_.dofs() - 6; ++body) sets.push_back(inertia_.dofs_of(body));
  for (const LoopPoints& loop : loops_) {
    sets.push_back(inertia_.dofs_of(loop.body_a));
    const std::vector<int> other = inertia_.dofs_of(loop.body_b);
    sets.back().insert(sets.back().end(), other.begin(), other.end());
  }
  for (const CoupledJoints& joints : couplings_) {
    sets.push_back(inertia_.dofs_of(joints.coupling.leader + 1));
    const std::vector<int> other = inertia_.dofs_of(joints.coupling.follower + 1);
    sets.back().insert(sets.back().end(), other.begin(), other.end());
  }
  return sets;
}

}  // namespace crossgait::contact
