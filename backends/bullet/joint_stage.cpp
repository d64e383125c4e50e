#include "crossgait/backends/bullet/joint_stage.h"

#include <Eigen/Cholesky>

#include "crossgait/backends/bullet/convert.h"
#include "crossgait/physics/error.h"

namespace crossgait::bullet {

JointStage::JointStage(const btMultiBody& body, const JointVector& armature, std::vector<LoopPoints> loops,
                       SoftLaw loop_law, double step)
    : inertia_(body, armature), loops_(std::move(loops)), law_(loop_law), step_(step), body_(body) {
  if (loops_.size() > kMaxLoops) {
    throw ConfigError("robot", "loops", "at most 16 loop closures", std::to_string(loops_.size()));
  }
  const Eigen::Index rows = 3 * static_cast<Eigen::Index>(loops_.size());
  Y_.setZero(inertia_.dofs(), rows);
  P_.setZero(rows, inertia_.dofs());
  regularization_.setZero(rows);
  rhs_.setZero(rows);
  K_.setZero(rows, rows);
}

void JointStage::solve(const DofVector& before, const DofVector& bullet, const JointVector& torque) noexcept {
  inertia_.update();
  solve_smooth(before, bullet, torque);
  if (loops_.empty()) return;

  assemble_loops(before);
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

// (M0 + A)(v' - v) = M0 (v_bullet - v) + h tau: Bullet's forward dynamics knows nothing of the armature A.
void JointStage::solve_smooth(const DofVector& before, const DofVector& bullet,
                              const JointVector& torque) noexcept {
  work_ = bullet - before;
  inertia_.multiply_bare(work_, velocity_);
  velocity_.tail(torque.size()) += step_ * torque;
  inertia_.half_solve(velocity_);
  inertia_.finish_solve(velocity_);
  velocity_ += before;
}

void JointStage::assemble_loops(const DofVector& before) noexcept {
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    const LoopPoints& loop = loops_[i];
    const Vector3 a = vector(body_.localPosToWorld(loop.link_a, vector(loop.p_AP)));
    const Vector3 b = vector(body_.localPosToWorld(loop.link_b, vector(loop.p_BP)));
    inertia_.point_jacobian(loop.link_a, a, J_a_);
    inertia_.point_jacobian(loop.link_b, b, J_b_);
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

void JointStage::project(Eigen::Ref<DofVector> y) const noexcept {
  if (loops_.empty()) return;
  LoopVector response(P_.rows());
  response.noalias() = P_ * y;
  y.noalias() -= P_.transpose() * response;
}

}  // namespace crossgait::bullet
