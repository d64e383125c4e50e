// Bullet's constraint solver with Crossgait's joint stage, and contacts and dry friction in joints made of
// either engine's factors.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>

#include "crossgait/backends/bullet/bounded_rows.h"
#include "crossgait/backends/bullet/cone_solver.h"
#include "crossgait/backends/bullet/contact_factors.h"
#include "crossgait/backends/bullet/joint_stage.h"
#include "crossgait/backends/bullet/multibody_model.h"
#include "crossgait/physics/state.h"

namespace crossgait::bullet {

/// How far above the ground a point of each link (base first) counts for Bullet's collision detection, m.
std::vector<double> contact_margins(const std::vector<LinkFeature>& features, int links);

/// Bullet's world calls it once per step, after its forward dynamics and collision detection. The joint stage
/// replaces Bullet's rows for armature and loops; contacts and joint friction follow the factors.
class ConstraintSolver final : public btMultiBodyConstraintSolver {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  ConstraintSolver(const WorldSpec& spec, const ContactFactors& factors, MultibodyModel& model);

  /// Call before the world steps: remembers velocities and the torques to apply.
  void begin_step(const JointVector& torque) noexcept;
  /// False if the step produced a value that is not finite (velocities were then zeroed so that Bullet's
  /// broadphase never sees one).
  bool finite() const noexcept { return finite_; }
  const ContactList& contacts() const noexcept { return contacts_; }
  const JointStage& joints() const noexcept { return joints_; }
  /// Dry friction of every joint, N m.
  JointVector joint_friction() const;

  void solveMultiBodyGroup(btCollisionObject** bodies, int body_count, btPersistentManifold** manifolds,
                           int manifold_count, btTypedConstraint** constraints, int constraint_count,
                           btMultiBodyConstraint** multibody_constraints, int multibody_constraint_count,
                           const btContactSolverInfo& info, btIDebugDraw* drawer,
                           btDispatcher* dispatcher) override;

 private:
  struct ContactPoint {
    int link = -1, leg = -1;
    Vector3 p_WP, normal;
    double distance = 0;
  };

  // contact_points.cpp
  void find_contacts() noexcept;
  void read_contacts(btPersistentManifold** manifolds, int count) noexcept;
  void find_contact(const LinkFeature& of, const Vector3& centre, double margin) noexcept;

  // All but Bullet's own sweeps: contact_law.cpp
  void solve_contacts() noexcept;
  void assemble_contacts() noexcept;
  void respond(Eigen::Index column, Eigen::MatrixXd& rows, Eigen::MatrixXd& projected) const noexcept;
  double set_row(int contact, int axis) noexcept;
  void apply_contacts() noexcept;

  // joint_friction.cpp
  void assemble_joint_friction() noexcept;
  void add_joint_friction(DofVector& change) const noexcept;
  void make_friction_motors();

  // Bullet's own sweeps: native_contact.cpp
  btScalar solveGroupCacheFriendlySetup(btCollisionObject** bodies, int body_count,
                                        btPersistentManifold** manifolds, int manifold_count,
                                        btTypedConstraint** constraints, int constraint_count,
                                        const btContactSolverInfo& info, btIDebugDraw* drawer) override;
  btScalar solveGroupCacheFriendlyFinish(btCollisionObject** bodies, int body_count,
                                         const btContactSolverInfo& info) override;
  void refer_to_joint_stage(btMultiBodySolverConstraint& row) noexcept;
  int leg_at(int link, const Vector3& p_WP) const noexcept;
  void report_native_contacts() noexcept;

  DofVector bullet_velocity() const noexcept;
  void set_velocity(const DofVector& velocity) noexcept;
  void report(const ContactPoint& point, const Vector3& force, const Vector3& velocity_before) noexcept;

  const WorldSpec& spec_;
  ContactFactors factors_;
  MultibodyModel& model_;
  JointStage joints_;
  SoftLaw contact_law_, friction_law_;
  std::vector<FrictionalJoint> frictional_joints_;
  std::vector<std::unique_ptr<btMultiBodyJointMotor>> friction_motors_;  // Bullet's own rows: one per joint
  std::vector<btMultiBodyConstraint*> motor_list_;                       // the same, as Bullet takes them
  std::vector<LinkFeature> features_;
  std::vector<double> margins_;
  std::vector<double> reach_;  // of each link's features (base first) from its centre of mass, m
  bool pending_ = false, finite_ = true;

  DofVector before_;      // velocities before the step
  DofVector correction_;  // of the joint stage to Bullet's velocities
  JointVector torque_;
  DeepestPoints<ContactPoint> points_;
  ConeProblem cone_;
  BoundedRows joint_friction_;
  PointJacobian J_;
  Eigen::MatrixXd rows_;                               // dofs x 3 contacts: half_solve(J')
  Eigen::MatrixXd projected_;                          // the same after project()
  Eigen::MatrixXd joint_rows_, projected_joints_;      // likewise: dofs x joints with friction
  std::array<Eigen::Matrix3d, kMaxContacts> frames_;   // rows: normal, two tangents
  std::array<Vector3, kMaxContacts> velocity_before_;  // in that frame
  ContactList contacts_;
};

}  // namespace crossgait::bullet
