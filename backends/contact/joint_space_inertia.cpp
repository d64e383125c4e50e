#include "backends/contact/joint_space_inertia.h"

#include <algorithm>
#include <cmath>

#include "physics/robot/actuator.h"

namespace crossgait::contact {

JointSpaceInertia::JointSpaceInertia(const RobotDescription& robot, bool fixed_base, double h)
    : armature_(robot.joint_count()), n_(6 + robot.joint_count()), first_(fixed_base ? 6 : 0) {
  for (int i = 0; i < 6; ++i) parent_[static_cast<std::size_t>(i)] = i - 1;
  for (int i = 0; i < robot.joint_count(); ++i) {
    const int parent = robot.bodies[static_cast<std::size_t>(i) + 1].parent;
    armature_[i] = step_armature(robot.joint(i), h);
    // What the base carries hangs on its last dof; under a fixed base it is a root.
    parent_[static_cast<std::size_t>(6 + i)] = parent > 0 ? 5 + parent : (first_ == 6 ? -1 : 5);
  }
}

void JointSpaceInertia::factor() noexcept {
  H_ = bare_;
  for (int i = 0; i < n_ - 6; ++i) H(6 + i, 6 + i) += armature_[i];
  for (int k = n_ - 1; k >= first_; --k) {
    const double d = H(k, k);
    sqrt_inverse_d_[static_cast<std::size_t>(k)] = 1 / std::sqrt(d);
    for (int i = parent(k); i >= 0; i = parent(i)) {
      const double a = H(k, i) / d;
      for (int j = i; j >= 0; j = parent(j)) H(i, j) -= a * H(k, j);
      H(k, i) = a;
    }
  }
}

void JointSpaceInertia::multiply_bare(const DofVector& x, DofVector& y) const noexcept {
  y.setZero(n_);
  for (int i = first_; i < n_; ++i) {
    y[i] += bare(i, i) * x[i];
    for (int j = parent(i); j >= 0; j = parent(j)) {
      y[i] += bare(i, j) * x[j];
      y[j] += bare(i, j) * x[i];
    }
  }
}

void JointSpaceInertia::half_solve(Eigen::Ref<DofVector> x) const noexcept {
  for (int i = n_ - 1; i >= first_; --i) {
    const double xi = x[i];
    if (xi == 0) continue;  // rows of one leg leave the others untouched
    for (int j = parent(i); j >= 0; j = parent(j)) x[j] -= H(i, j) * xi;
    x[i] = xi * sqrt_inverse_d_[static_cast<std::size_t>(i)];
  }
  for (int i = 0; i < first_; ++i) x[i] = 0;
}

void JointSpaceInertia::finish_solve(DofVector& x) const noexcept {
  for (int i = first_; i < n_; ++i) {
    double xi = x[i] * sqrt_inverse_d_[static_cast<std::size_t>(i)];
    for (int j = parent(i); j >= 0; j = parent(j)) xi -= H(i, j) * x[j];
    x[i] = xi;
  }
}

void JointSpaceInertia::half_solve_rows(std::span<const int> dofs, PointJacobian& J) const noexcept {
  for (auto dof = dofs.rbegin(); dof != dofs.rend(); ++dof) {
    const int i = *dof;
    const Vector3 column = J.col(i);
    for (int j = parent(i); j >= 0; j = parent(j)) J.col(j) -= H(i, j) * column;
    J.col(i) = sqrt_inverse_d_[static_cast<std::size_t>(i)] * column;
  }
}

void JointSpaceInertia::half_multiply(DofVector& x) const noexcept {
  for (int i = n_ - 1; i >= first_; --i) {
    for (int j = parent(i); j >= 0; j = parent(j)) x[i] += H(i, j) * x[j];
    x[i] /= sqrt_inverse_d_[static_cast<std::size_t>(i)];
  }
  for (int i = 0; i < first_; ++i) x[i] = 0;
}

std::vector<int> JointSpaceInertia::dofs_of(int body) const {
  std::vector<int> dofs;
  for (int i = last_dof(body); i >= 0; i = parent(i)) dofs.push_back(i);
  std::reverse(dofs.begin(), dofs.end());
  return dofs;
}

Eigen::MatrixXd JointSpaceInertia::bare_matrix() const {
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n_, n_);
  for (int i = 0; i < n_; ++i) {
    for (int j = i; j >= 0; j = parent(j)) M(i, j) = M(j, i) = bare(i, j);
  }
  return M;
}

}  // namespace crossgait::contact
