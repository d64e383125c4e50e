// The joint-space inertia of a btMultiBody with armature, factored for fast repeated solves.
#pragma once

#include <array>

#include <BulletDynamics/Featherstone/btMultiBody.h>

#include "crossgait/physics/math.h"

namespace crossgait::bullet {

/// Degrees of freedom in Bullet's order [w_W, v_W of the base's centre of mass, joint velocities].
inline constexpr int kMaxDofs = 6 + kMaxJoints;
using DofVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxDofs, 1>;
using PointJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxDofs>;

/// M = M0 + diag(armature) by the composite-rigid-body algorithm in world axes about the base's centre of
/// mass (Featherstone 2008, section 6.2), factored as L^T D L along the tree (section 6.5). Bullet itself
/// offers the inverse of M0 alone, one column per 0.8 us tree traversal; every constraint row needs the
/// inverse *with* armature. Tests hold M0 against the inverse that Bullet's articulated-body algorithm gives.
class JointSpaceInertia {
 public:
  /// @param armature per joint, kg m^2
  JointSpaceInertia(const btMultiBody& body, const JointVector& armature);

  /// Reads the world transforms that Bullet cached for the current configuration and refactors.
  void update() noexcept;

  int dofs() const noexcept { return n_; }
  /// First dof that can move: 0, or 6 for a fixed base.
  int first_dof() const noexcept { return first_; }
  /// y = M0 x, without armature.
  void multiply_bare(const DofVector& x, DofVector& y) const noexcept;
  /// x <- D^-1/2 L^-T x, so that x.y afterwards is x^T M^-1 y.
  void half_solve(Eigen::Ref<DofVector> x) const noexcept;
  /// x <- L^-1 D^-1/2 x, which completes `half_solve` to M^-1.
  void finish_solve(DofVector& x) const noexcept;
  /// Velocity of the point p_WP of link `link` (-1: base) per unit of each dof, W.
  void point_jacobian(int link, const Vector3& p_WP, PointJacobian& J) const noexcept;
  /// M0 (without armature), symmetric.
  Eigen::MatrixXd bare_matrix() const;

 private:
  struct Composite {  // spatial inertia about the reference point, world axes
    double mass;
    Vector3 moment;  // mass times centre of mass
    Matrix3 inertia;
  };
  void accumulate_composites() noexcept;
  void fill_matrix() noexcept;
  void factor() noexcept;
  double& H(int row, int column) noexcept { return H_[static_cast<std::size_t>(row * kMaxDofs + column)]; }
  double H(int row, int column) const noexcept {
    return H_[static_cast<std::size_t>(row * kMaxDofs + column)];
  }

  const btMultiBody& body_;
  JointVector armature_;
  int n_ = 0, first_ = 0;
  std::array<int, kMaxDofs> parent_{};  // dof one up the tree, or -1
  std::array<int, kMaxJoints> parent_link_{};
  Vector3 reference_ = Vector3::Zero();              // base centre of mass, W
  std::array<Vector3, kMaxJoints> axis_w_, axis_v_;  // joint motion: angular, and linear at the reference
  std::array<Composite, kMaxJoints + 1> composite_;  // base first
  std::array<double, kMaxDofs * kMaxDofs> H_{};      // lower triangle of M0, then of L and D
  std::array<double, kMaxDofs * kMaxDofs> bare_{};   // lower triangle of M0
  std::array<double, kMaxDofs> sqrt_inverse_d_{};
};

}  // namespace crossgait::bullet
