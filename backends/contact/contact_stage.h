// Contacts, dry friction and limits of joints, and implicit servos in one step, by a law made of LawFactors.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "backends/contact/contact_points.h"
#include "backends/contact/dual_problem.h"
#include "backends/contact/joint_friction.h"
#include "backends/contact/joint_limit.h"
#include "backends/contact/law_factors.h"
#include "backends/contact/primal_problem.h"
#include "backends/contact/sweep_problem.h"
#include "physics/engine/physics_backend.h"

namespace crossgait::contact {

/// Solves contacts; with MuJoCo's factors they are placed midway between the surfaces, softened like
/// MuJoCo's, and solved over true friction cones, of torsion and rolling too; any of these can be another's.
class ContactStage {
 public:
  /// @param spec,bodies,joints  must outlive it
  /// @throws ConfigError where the law is MuJoCo's and the spec asks for pyramidal cones, which are not
  /// solved here
  /// @param sweeps  solve by as many sweeps as the spec has iterations, converged or not; needs Coulomb's law
  ContactStage(const WorldSpec& spec, const LawFactors& factors, const BodyKinematics& bodies,
               const JointStage& joints, bool sweeps = false);

  /// Forgets the contacts of the last step.
  void begin_step() noexcept { contacts_.clear(); }

  /// Solves and reports after the joint stage.
  /// @param before  velocities before the step
  /// @param angles  of the joints before the step, rad
  /// @returns velocities after the step
  const DofVector& solve(const DofVector& before, const JointVector& angles, const ContactPoints& points,
                         std::span<const ImplicitServo> servos) noexcept;

  /// @param force,velocity_before  on the robot, N, and of the body at the point, m/s, in W
  void report(const ContactPoint& point, const Vector3& force, const Vector3& velocity_before) noexcept;
  const ContactList& contacts() const noexcept { return contacts_; }

  /// Returns the dry friction of every joint, N m.
  JointVector joint_friction() const;
  JointRanges joint_limits() const;
  const std::vector<FrictionalJoint>& frictional_joints() const noexcept { return frictional_joints_; }
  const std::vector<LimitedJoint>& limited_joints() const noexcept { return limited_joints_; }

 private:
  struct ContactRows {
    Matrix3 frame;            // rows: normal, two tangents
    Vector3 velocity_before;  // in that frame
    Vector3 R, b;             // regularisation; velocity less what the rows ask for
    double impedance = 0;     // of soft rows
  };

  struct LimitedDof {
    int dof = 0;
    LimitRow row;
  };

  std::span<const int> dofs_of(int body) const noexcept { return dofs_[static_cast<std::size_t>(body)]; }
  double coefficient() const noexcept;
  void find_limits(const DofVector& before, const JointVector& angles) noexcept;
  void sweep() noexcept;
  template <typename Problem>
  void add_rows(Problem& problem, const DofVector& before, const ContactPoints& points,
                std::span<const ImplicitServo> servos) noexcept;
  template <typename Problem>
  void add_joint_rows(Problem& problem, const DofVector& before) noexcept;
  template <typename Problem>
  void add_servos(Problem& problem, const DofVector& before, std::span<const ImplicitServo> servos) noexcept;
  template <int kRows>
  void add_turning_contact(PrimalProblemOf<kRows>& problem, const DofVector& before,
                           const ContactPoint& point, const ContactRows& rows) noexcept;
  template <typename Primal>
  void solve_primal(Primal& problem, const DofVector& before, const ContactPoints& points,
                    std::span<const ImplicitServo> servos) noexcept;
  void describe(const ContactPoint& point, const DofVector& before, ContactRows& rows) noexcept;
  Matrix3 frame_at(const ContactPoint& point, const DofVector& before) const noexcept;
  double set_row(const ContactPoint& point, int axis, ContactRows& rows) const noexcept;
  Vector3 place_of_force(const ContactPoint& point) const noexcept;
  void find_turning(int body, const Vector3& p_WP) noexcept;
  template <typename Problem>
  void apply(const Problem& problem, const ContactPoints& points) noexcept;

  const WorldSpec& spec_;
  LawFactors factors_;
  HardContact hard_;
  const BodyKinematics& bodies_;
  const JointStage& joints_;
  SoftLaw contact_law_, friction_law_;
  std::vector<double> inverse_weights_;  // MuJoCo's, by body, 1/kg
  std::vector<FrictionalJoint> frictional_joints_;
  std::vector<LimitedJoint> limited_joints_;
  std::array<LimitedDof, kMaxJoints> limits_;  // that count in this step
  int limit_count_ = 0;
  std::vector<std::vector<int>> dofs_;  // by body: those that move it, rising

  bool sweeps_;
  std::unique_ptr<PrimalProblem> primal_;  // one of the five
  std::unique_ptr<PrimalProblemOf<4>> twisting_;
  std::unique_ptr<PrimalProblemOf<6>> rolling_;
  std::unique_ptr<SweepProblem> sweep_;
  std::unique_ptr<DualProblem> dual_;
  std::array<ContactRows, kMaxContacts> rows_;
  Eigen::MatrixXd loops_;
  PointJacobian J_;
  PointJacobian turning_, along_x_, along_y_;  // angular velocity in W per unit of each dof; see find_turning
  DofVector velocity_;
  ContactList contacts_;
};

}  // namespace crossgait::contact
