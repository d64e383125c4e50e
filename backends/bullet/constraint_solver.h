// What Bullet's world calls to solve constraints: Crossgait's joint stage, and contacts and dry friction in
// joints made of either engine's factors.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <BulletDynamics/Featherstone/btMultiBodyConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>

#include "backends/bullet/composite_inertia.h"
#include "backends/bullet/contact_factors.h"
#include "backends/bullet/multibody_model.h"
#include "backends/contact/contact_stage.h"

namespace crossgait::bullet {

/// Says how far above the ground a link's point (base first) counts for Bullet's collision detection, m.
std::vector<double> contact_margins(const std::vector<contact::BodyFeature>& features, int links);

/// Bullet's world calls it once per step, after its forward dynamics and collision detection. The joint stage
/// replaces Bullet's rows for armature and loops; contacts and joint friction follow the factors.
class ConstraintSolver final : public btMultiBodyConstraintSolver {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// @param own_code  contacts and dry friction in joints by Bullet's own code; for all of Bullet's factors
  ConstraintSolver(const WorldSpec& spec, const ContactFactors& factors, bool own_code,
                   MultibodyModel& model);

  /// Remembers velocities and the torques to apply; call it before the world steps.
  /// @param servos  that are implicit; has to stay as it is until the world has stepped
  void begin_step(const JointVector& torque, std::span<const ImplicitServo> servos) noexcept;
  /// Returns false if the step produced a value that is not finite (velocities were then zeroed so that
  /// Bullet's broadphase never sees one).
  bool finite() const noexcept { return finite_; }
  const contact::ContactStage& contact_stage() const noexcept { return contacts_; }

  void solveMultiBodyGroup(btCollisionObject** bodies, int body_count, btPersistentManifold** manifolds,
                           int manifold_count, btTypedConstraint** constraints, int constraint_count,
                           btMultiBodyConstraint** multibody_constraints, int multibody_constraint_count,
                           const btContactSolverInfo& info, btIDebugDraw* drawer,
                           btDispatcher* dispatcher) override;

 private:
  // contact_points.cpp
  void read_contacts(btPersistentManifold** manifolds, int count) noexcept;
  int leg_at(int link, const Vector3& p_WP) const noexcept;

  // Bullet's own code: native_contact.cpp
  btScalar solveGroupCacheFriendlySetup(btCollisionObject** bodies, int body_count,
                                        btPersistentManifold** manifolds, int manifold_count,
                                        btTypedConstraint** constraints, int constraint_count,
                                        const btContactSolverInfo& info, btIDebugDraw* drawer) override;
  btScalar solveGroupCacheFriendlyFinish(btCollisionObject** bodies, int body_count,
                                         const btContactSolverInfo& info) override;
  void bound_correction(btMultiBodySolverConstraint& row, double violation, double share,
                        double fastest) const noexcept;
  void refer_to_joint_stage(btMultiBodySolverConstraint& row, double mixing) noexcept;
  void make_joint_rows();
  void report_native_contacts() noexcept;

  DofVector bullet_velocity() const noexcept;
  void set_velocity(const DofVector& velocity) noexcept;

  const WorldSpec& spec_;
  ContactFactors factors_;
  bool own_code_;
  MultibodyModel& model_;
  CompositeInertia composite_;
  contact::BodyKinematics bodies_;
  contact::JointStage joints_;
  contact::ContactFinder finder_;
  contact::ContactPoints points_;
  contact::ContactStage contacts_;
  std::vector<std::unique_ptr<btMultiBodyConstraint>> joint_rows_;  // Bullet's own, of friction and limits
  std::vector<btMultiBodyConstraint*> joint_row_list_;              // the same, as Bullet takes them
  bool pending_ = false, finite_ = true;

  DofVector before_;      // velocities before the step
  DofVector impulse_;     // of Bullet's forward dynamics, M0 (v' - v)
  DofVector correction_;  // of the joint stage to Bullet's velocities
  JointVector torque_, angles_;
  std::span<const ImplicitServo> servos_;
  PointJacobian J_;
};

}  // namespace crossgait::bullet
