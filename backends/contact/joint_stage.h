// Everything bilateral of one step: armature, joint torques, closed loops and coupled joints, eliminated
// exactly.
#pragma once

#include <vector>

#include "backends/contact/body_kinematics.h"
#include "backends/contact/sparse_symmetric.h"
#include "physics/engine/soft_law.h"
#include "physics/engine/world_spec.h"

namespace crossgait::contact {

/// Sweeps converge badly here (armature is sixty times a link's inertia), so the joint rows and the loops are
/// eliminated by one factorisation, whatever the law of contact. With the rows J of loops, their
/// regularisation R and E = half_solve(J') R^-1/2, the inertia of a machine whose loops hold is 1 + E E', in
/// units in which without them it is the identity (Woodbury's identity). It has the pattern of the tree and
/// its loops, and contacts see the robot through it. A coupling of two joints is a row like those of loops,
/// in joint angles.
class JointStage {
 public:
  /// @param spec,bodies  must outlive it
  JointStage(const WorldSpec& spec, const BodyKinematics& bodies);

  /// Returns the inertia for the engine to fill in each step, before `solve`.
  JointSpaceInertia& inertia() noexcept { return inertia_; }
  const JointSpaceInertia& inertia() const noexcept { return inertia_; }

  /// @param before   velocities before the step
  /// @param impulse  M0 (v' - v) by the engine's own dynamics (gravity, gyroscopic and applied forces)
  /// @param angles   of the joints before the step, rad
  /// @param torque   joint torques, N m
  void solve(const DofVector& before, const DofVector& impulse, const JointVector& angles,
             const JointVector& torque) noexcept;

  /// Returns velocities after torques, armature, loops and couplings, before contact.
  const DofVector& velocity() const noexcept { return velocity_; }

  /// Projects y = half_solve(J') to what remains of it once the loops respond: half_solve'(y_p) = M_loops^-1
  /// J'.
  void project(Eigen::Ref<DofVector> y) const noexcept;

  /// Counts the rows of loops, three each, and of couplings.
  Eigen::Index row_count() const noexcept {
    return static_cast<Eigen::Index>(3 * loops_.size() + couplings_.size());
  }
  /// Returns 1 + E E', as it is and factored.
  const SparseSymmetric& loop_inertia() const noexcept { return loop_inertia_; }
  const SparseSymmetric& held_inertia() const noexcept { return held_inertia_; }
  /// Writes E, dofs x rows.
  void scaled_loop_rows(Eigen::MatrixXd& E) const noexcept;
  /// Lists sets of dofs that act on one another: of each body those that move it, and both ends of each loop
  /// and of each coupling.
  std::vector<std::vector<int>> coupled_dofs() const;

 private:
  static constexpr int kMaxLoops = 16;

  // Rows of E, and what they have to change, over the root of the regularisation. A coupling has one of
  // three.
  struct Rows {
    std::vector<int> dofs;  // that they act on, rising
    PointJacobian E;        // 3 x dofs: of these columns alone
    Vector3 wanted = Vector3::Zero();
  };

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

  void solve_smooth(const DofVector& before, const DofVector& impulse, const JointVector& torque) noexcept;
  void assemble_loops(const DofVector& before) noexcept;
  void assemble_couplings(const DofVector& before, const JointVector& angles) noexcept;
  std::vector<int> dofs_of_both(int body_a, int body_b) const;

  JointSpaceInertia inertia_;
  const BodyKinematics& bodies_;
  std::vector<LoopPoints> loops_;
  std::vector<CoupledJoints> couplings_;
  SoftLaw law_;
  double step_;

  DofVector velocity_, work_;
  PointJacobian J_b_;
  std::vector<Rows> rows_;  // of loops, then of couplings
  SparseSymmetric loop_inertia_, held_inertia_;
};

}  // namespace crossgait::contact
