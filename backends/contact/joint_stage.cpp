#include "backends/contact/joint_stage.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "physics/core/error.h"
#include "physics/robot/multibody.h"

namespace crossgait::contact {

JointStage::JointStage(const WorldSpec& spec, const BodyKinematics& bodies)
    : inertia_(*spec.robot, spec.fixed_base, spec.physics_dt),
      bodies_(bodies),
      law_(spec.robot->loop_softness, spec.physics_dt),
      step_(spec.physics_dt),
      loop_inertia_(0, {}),
      held_inertia_(0, {}) {
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
  const PointJacobian none = PointJacobian::Zero(3, inertia_.dofs());
  for (const LoopPoints& loop : loops_) rows_.push_back({dofs_of_both(loop.body_a, loop.body_b), none});
  for (const auto& [coupling, law, inverse_weight] : couplings_)
    rows_.push_back({dofs_of_both(coupling.leader + 1, coupling.follower + 1), none});
  loop_inertia_ = held_inertia_ = SparseSymmetric(inertia_.dofs(), coupled_dofs());
  loop_inertia_.set_identity();
}

void JointStage::solve(const DofVector& before, const DofVector& impulse, const JointVector& angles,
                       const JointVector& torque) noexcept {
  solve_smooth(before, impulse, torque);
  if (row_count() == 0) return;

  assemble_loops(before);
  assemble_couplings(before, angles);
  loop_inertia_.set_identity();
  work_.setZero(inertia_.dofs());
  for (const Rows& rows : rows_) {
    loop_inertia_.add_products(rows.dofs, rows.E);
    for (const int dof : rows.dofs) work_[dof] += rows.E.col(dof).dot(rows.wanted);
  }
  held_inertia_.copy_values(loop_inertia_);
  held_inertia_.factor();
  held_inertia_.solve(work_);
  inertia_.finish_solve(work_);
  velocity_ += work_;
}

// (M0 + A)(v' - v) = M0 (v_free - v) + h tau: the engine's dynamics knows nothing of the armature A.
void JointStage::solve_smooth(const DofVector& before, const DofVector& impulse,
                              const JointVector& torque) noexcept {
  velocity_ = impulse;
  velocity_.tail(torque.size()) += step_ * torque;
  inertia_.half_solve(velocity_);
  inertia_.finish_solve(velocity_);
  velocity_ += before;
}

void JointStage::assemble_loops(const DofVector& before) noexcept {
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    const LoopPoints& loop = loops_[i];
    Rows& rows = rows_[i];
    const Vector3 a = bodies_.point(loop.body_a, loop.p_A);
    const Vector3 b = bodies_.point(loop.body_b, loop.p_B);
    bodies_.point_jacobian(loop.body_a, a, rows.E);
    bodies_.point_jacobian(loop.body_b, b, J_b_);
    Vector3 was = Vector3::Zero(), is = Vector3::Zero();  // m/s, of the gap
    for (const int dof : rows.dofs) {
      rows.E.col(dof) -= J_b_.col(dof);
      was += before[dof] * rows.E.col(dof);
      is += velocity_[dof] * rows.E.col(dof);
    }
    const Vector3 gap = a - b;
    const double imp = law_.impedance(gap.norm());  // MuJoCo takes the norm of the gap for all three rows
    const double scale = 1 / std::sqrt(SoftLaw::regularization(imp, loop.inverse_weight));
    for (int k = 0; k < 3; ++k) rows.wanted[k] = scale * (law_.target_velocity(was[k], imp, gap[k]) - is[k]);
    inertia_.half_solve_rows(rows.dofs, rows.E);
    for (const int dof : rows.dofs) rows.E.col(dof) *= scale;
  }
}

// As mjEQ_JOINT of MuJoCo (engine_core_constraint.c, mj_instantiateEqual; weights: mj_diagApprox).
void JointStage::assemble_couplings(const DofVector& before, const JointVector& angles) noexcept {
  for (std::size_t i = 0; i < couplings_.size(); ++i) {
    const auto& [coupling, law, inverse_weight] = couplings_[i];
    Rows& rows = rows_[loops_.size() + i];
    const double leader = angles[coupling.leader], slope = coupling.slope_at(leader);
    const double violation = angles[coupling.follower] - coupling.follower_at(leader);
    const Eigen::Index to = 6 + coupling.follower, from = 6 + coupling.leader;
    const double imp = law.impedance(violation);
    const double scale = 1 / std::sqrt(SoftLaw::regularization(imp, inverse_weight));
    const double target = law.target_velocity(before[to] - slope * before[from], imp, violation);
    rows.wanted[0] = scale * (target - (velocity_[to] - slope * velocity_[from]));
    for (const int dof : rows.dofs) rows.E.col(dof).setZero();
    rows.E(0, to) = scale;
    rows.E(0, from) = -scale * slope;
    inertia_.half_solve_rows(rows.dofs, rows.E);
  }
}

// (R + Y'Y)^-1 of the loops' own rows, Y = half_solve(J'), taken to the dofs: 1 - Y (R + Y'Y)^-1 Y' is the
// inverse of 1 + E E'.
// NOLINTNEXTLINE(performance-unnecessary-value-param): a reference
void JointStage::project(Eigen::Ref<DofVector> y) const noexcept {
  if (row_count() > 0) held_inertia_.solve(y);
}

void JointStage::scaled_loop_rows(Eigen::MatrixXd& E) const noexcept {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const bool is_loop = i < loops_.size();
    const auto first = static_cast<Eigen::Index>(is_loop ? 3 * i : 2 * loops_.size() + i);
    for (const int dof : rows_[i].dofs) {
      for (int k = 0; k < (is_loop ? 3 : 1); ++k) E(dof, first + k) = rows_[i].E(k, dof);
    }
  }
}

std::vector<int> JointStage::dofs_of_both(int body_a, int body_b) const {
  const std::vector<int> a = inertia_.dofs_of(body_a), b = inertia_.dofs_of(body_b);
  std::vector<int> both;
  std::ranges::set_union(a, b, std::back_inserter(both));
  return both;
}

std::vector<std::vector<int>> JointStage::coupled_dofs() const {
  std::vector<std::vector<int>> sets;
  for (int body = 0; body <= inertia_.dofs() - 6; ++body) sets.push_back(inertia_.dofs_of(body));
  for (const Rows& rows : rows_) sets.push_back(rows.dofs);
  return sets;
}

}  // namespace crossgait::contact
