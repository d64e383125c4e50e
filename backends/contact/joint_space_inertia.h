// The joint-space inertia of a robot with armature, factored for fast repeated solves.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "physics/robot/robot.h"

namespace crossgait::contact {

/// Degrees of freedom: six of the base, in whatever terms the engine has them (its velocities, inertia and
/// Jacobians have to agree), then joint velocities. A fixed base keeps its six, which never move.
inline constexpr int kMaxDofs = 6 + kMaxJoints;
using DofVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxDofs, 1>;
using PointJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxDofs>;

/// Factors M = M0 + diag(step_armature) as L^T D L along the tree (Featherstone 2008, section 6.5). M0 is the
/// engine's: it fills the lower triangle, and calls `factor`.
class JointSpaceInertia {
 public:
  /// @param h  physics step, s
  JointSpaceInertia(const RobotDescription& robot, bool fixed_base, double h);

  /// Returns an entry of M0, row >= column. Of joints only those are read whose bodies carry one another:
  /// `parent` leads from row to column.
  double& bare(int row, int column) noexcept {
    return bare_[static_cast<std::size_t>(row * kMaxDofs + column)];
  }
  double bare(int row, int column) const noexcept {
    return bare_[static_cast<std::size_t>(row * kMaxDofs + column)];
  }
  /// Factors M after M0 was filled.
  void factor() noexcept;

  int dofs() const noexcept { return n_; }
  /// Returns the first dof that can move: 0, or 6 for a fixed base.
  int first_dof() const noexcept { return first_; }
  /// Returns the dof one up the tree; -1 of a root.
  int parent(int dof) const noexcept { return parent_[static_cast<std::size_t>(dof)]; }
  /// Computes y = M0 x, without armature.
  void multiply_bare(const DofVector& x, DofVector& y) const noexcept;
  /// Computes x <- D^-1/2 L^-T x, so that x.y afterwards is x^T M^-1 y.
  void half_solve(Eigen::Ref<DofVector> x) const noexcept;
  /// Computes x <- L^-1 D^-1/2 x, which completes `half_solve` to M^-1.
  void finish_solve(DofVector& x) const noexcept;
  /// Does `half_solve` of three rows at once: J <- J L^-1 D^-1/2, of rows that are zero but in the columns
  /// `dofs`; the others are not looked at. @param dofs  rising, and with each those that it hangs on
  void half_solve_rows(std::span<const int> dofs, PointJacobian& J) const noexcept;
  /// Computes x <- D^1/2 L x: undoes `finish_solve`.
  void half_multiply(DofVector& x) const noexcept;
  /// Returns the last dof that moves a body: that of its joint; -1 for what nothing moves.
  int last_dof(int body) const noexcept { return body > 0 ? 5 + body : (first_ == 0 ? 5 : -1); }
  /// Lists all dofs that move a body, rising.
  std::vector<int> dofs_of(int body) const;
  /// Returns M0 (without armature), symmetric.
  Eigen::MatrixXd bare_matrix() const;

 private:
  double& H(int row, int column) noexcept { return H_[static_cast<std::size_t>(row * kMaxDofs + column)]; }
  double H(int row, int column) const noexcept {
    return H_[static_cast<std::size_t>(row * kMaxDofs + column)];
  }

  JointVector armature_;  // kg m^2
  int n_ = 0, first_ = 0;
  std::array<int, kMaxDofs> parent_{};
  std::array<double, kMaxDofs * kMaxDofs> bare_{};  // lower triangle of M0
  std::array<double, kMaxDofs * kMaxDofs> H_{};     // of L and D
  std::array<double, kMaxDofs> sqrt_inverse_d_{};
};

}  // namespace crossgait::contact
