// Everything bilateral of one step: armature, joint torques, closed loops and coupled joints, eliminated
// exactly.
#pragma once

#include <vector>

#include "backends/contact/body_kinematics.h"
#include "physics/engine/soft_law.h"
#include "physics/engine/world_spec.h"

namespace crossgait::contact {

/// Sweeps converge badly here (armature is sixty times a link's inertia), so the joint rows and the loops are
/// eliminated by one Cholesky factorisation, whatever the law of contact. Contacts then see the robot through
/// `project`: the inverse inertia of a machine whose loops hold. A coupling of two joints is a row like those
/// of loops, in joint angles.
class JointStage {
 public:
  /// @param spec,bodies  must outlive it
  JointStage(const WorldSpec& spec, const BodyKinematics& bodies);

  /// Returns the inertia for the engine to fill in each step, before `solve`.
  JointSpaceInertia& inertia() noexcept { return inertia_; }
  const JointSpaceInertia& inertia() const noexcept { return inertia_; }

  /// @param before  velocities before the step
  /// @param free    velocities after the engine's own forward dynamics (gravity, gyroscopic and applied
  /// forces; M0)
  /// @param angles  of the joints before the step, rad
  /// @param torque  joint torques, N m
  void solve(const DofVector& before, const DofVector& free, const JointVector& angles,
             const JointVector& torque) noexcept;

  /// Returns velocities after torques, armature, loops and couplings, before contact.
  const DofVector& velocity() const noexcept { return velocity_; }

  /// Projects y = half_solve(J') to what remains of it once the loops respond: half_solve'(y_p) = M_loops^-1
  /// J'.
  void project(Eigen::Ref<DofVector> y) const noexcept;

  /// Counts the rows of loops, three each, and of couplings.
  Eigen::Index row_count() const noexcept { return rhs_.size(); }
  /// Computes E = half_solve(J') of these rows over the root of their regularisation, dofs x rows: the
  /// inverse of what `project` does is 1 + E E'.
  void scaled_loop_rows(Eigen::MatrixXd& E) const noexcept;
  /// Lists sets of dofs that act on one another: of each body those that move it, and both ends of each loop
  /// and of each coupling.
  std::vector<std::vector<int>> coupled_dofs() const;

 private:
  static constexpr int kMaxLoops = 16;
  static constexpr int kMaxRows = 3 * kMaxLoops + kMaxJoints;
  using LoopMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxRows, kMaxRows>;
  using LoopVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxRows, 1>;

  struct LoopPoints {
    int body_a, body_b;
    Vector3 p_A, p_B;       // in the bodies' frames C
    double inverse_weight;  // 1/kg, sum over both bodies
  };

  struct CoupledJoints {
    JointCoupling coupling;
    SoftLaw law;
    double inverse_weight;  // 1/(kg m^2), sum over both joints
  };

  void solve_smooth(const DofVector& before, const DofVector& free, const JointVector& torque) noexcept;
  void assemble_loops(const DofVector& before) noexcept;
  void assemble_couplings(const DofVector& before, const JointVector& angles) noexcept;

  JointSpaceInertia inertia_;
  const BodyKinematics& bodies_;
  std::vector<LoopPoints> loops_;
  std::vector<CoupledJoints> couplings_;
  SoftLaw law_;
  double step_;

  DofVector velocity_, work_;
  PointJacobian J_a_, J_b_;
  Eigen::MatrixXd Y_;  // dofs x rows: half_solve(J')
  Eigen::MatrixXd P_;  // rows x dofs: L_K^-1 Y', where L_K L_K' = Y'Y + R
  LoopVector regularization_, rhs_;
  LoopMatrix K_;
};

}  // namespace crossgait::contact
