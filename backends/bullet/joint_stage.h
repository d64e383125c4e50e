// Everything bilateral of one step: armature, joint torques and closed loops, eliminated exactly.
#pragma once

#include <vector>

#include "crossgait/backends/bullet/joint_space_inertia.h"
#include "crossgait/backends/bullet/soft_constraint.h"
#include "crossgait/physics/robot.h"

namespace crossgait::bullet {

/// A loop closure between two points given in the links' centre-of-mass frames.
struct LoopPoints {
  int link_a = -1, link_b = -1;  ///< Bullet links; -1 is the base
  Vector3 p_AP = Vector3::Zero(), p_BP = Vector3::Zero();
  double inverse_weight = 0;  ///< 1/kg, sum over both bodies
};

/// Bullet's Gauss-Seidel sweeps converge badly here (armature is sixty times a link's inertia), so the joint
/// rows and the loops are eliminated by one Cholesky factorisation, in both contact modes. Contacts then see
/// the robot through `project`: the inverse inertia of a machine whose loops hold.
class JointStage {
 public:
  JointStage(const btMultiBody& body, const JointVector& armature, std::vector<LoopPoints> loops,
             SoftLaw loop_law, double step);

  /// @param before   velocities before the step
  /// @param bullet   velocities after Bullet's own forward dynamics (gravity, gyroscopic and applied forces;
  /// M0)
  /// @param torque   joint torques, N m
  void solve(const DofVector& before, const DofVector& bullet, const JointVector& torque) noexcept;

  /// Velocities after torques, armature and loops, before contact.
  const DofVector& velocity() const noexcept { return velocity_; }
  const JointSpaceInertia& inertia() const noexcept { return inertia_; }

  /// Given y = half_solve(J'), returns what remains of it once the loops respond: half_solve'(y_p) =
  /// M_loops^-1 J'.
  void project(Eigen::Ref<DofVector> y) const noexcept;

 private:
  static constexpr int kMaxLoops = 16;
  using LoopMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3 * kMaxLoops, 3 * kMaxLoops>;
  using LoopVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3 * kMaxLoops, 1>;

  void solve_smooth(const DofVector& before, const DofVector& bullet, const JointVector& torque) noexcept;
  void assemble_loops(const DofVector& before) noexcept;

  JointSpaceInertia inertia_;
  std::vector<LoopPoints> loops_;
  SoftLaw law_;
  double step_;
  const btMultiBody& body_;

  DofVector velocity_, work_;
  PointJacobian J_a_, J_b_;
  Eigen::MatrixXd Y_;  // dofs x 3 loops: half_solve(J')
  Eigen::MatrixXd P_;  // 3 loops x dofs: L_K^-1 Y', where L_K L_K' = Y'Y + R
  LoopVector regularization_, rhs_;
  LoopMatrix K_;
};

}  // namespace crossgait::bullet
