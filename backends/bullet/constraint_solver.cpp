#include "crossgait/backends/bullet/constraint_solver.h"

#include <algorithm>

#include "crossgait/backends/bullet/convert.h"

namespace crossgait::bullet {

ConstraintSolver::ConstraintSolver(const WorldSpec& spec, const ContactFactors& factors,
                                   MultibodyModel& model)
    : spec_(spec),
      factors_(factors),
      model_(model),
      joints_(model.body(), model.armature(), model.loop_points(),
              SoftLaw(spec.robot->loop_softness, spec.physics_dt), spec.physics_dt),
      contact_law_(spec.contact.softness, spec.physics_dt),
      friction_law_(spec.robot->friction_softness, spec.physics_dt),
      frictional_joints_(model.frictional_joints()),
      features_(model.contact_features()),
      margins_(contact_margins(features_, model.body().getNumLinks())),
      torque_(JointVector::Zero(spec.robot->joint_count())) {
  reach_.assign(margins_.size(), 0);
  for (const LinkFeature& of : features_) {
    double& farthest = reach_[static_cast<std::size_t>(of.link + 1)];
    farthest = std::max(farthest, of.p_CF.norm() + of.feature.rim + of.feature.radius);
  }
  const Eigen::Index n = joints_.inertia().dofs();
  before_.setZero(n);
  correction_.setZero(n);
  rows_.setZero(n, ConeProblem::kMaxRows);
  projected_.setZero(n, ConeProblem::kMaxRows);
  joint_friction_.count = static_cast<int>(frictional_joints_.size());
  joint_rows_.setZero(n, joint_friction_.count);
  projected_joints_.setZero(n, joint_friction_.count);
  if (factors_.sweeps) make_friction_motors();
}

DofVector ConstraintSolver::bullet_velocity() const noexcept {
  return Eigen::Map<const Eigen::VectorXd>(model_.body().getVelocityVector(), before_.size());
}

void ConstraintSolver::set_velocity(const DofVector& velocity) noexcept {
  btMultiBody& body = model_.body();
  body.setBaseOmega(vector(Vector3(velocity.head<3>())));
  body.setBaseVel(vector(Vector3(velocity.segment<3>(3))));
  for (int i = 0; i < body.getNumLinks(); ++i) body.setJointVel(i, velocity[6 + i]);
}

void ConstraintSolver::begin_step(const JointVector& torque) noexcept {
  before_ = bullet_velocity();
  torque_ = torque;
  contacts_.clear();
  pending_ = true;
  finite_ = true;
}

void ConstraintSolver::solveMultiBodyGroup(btCollisionObject** bodies, int body_count,
                                           btPersistentManifold** manifolds, int manifold_count,
                                           btTypedConstraint** constraints, int constraint_count,
                                           btMultiBodyConstraint** /*multibody_constraints*/,
                                           int /*multibody_constraint_count*/,
                                           const btContactSolverInfo& info, btIDebugDraw* drawer,
                                           btDispatcher* dispatcher) {
  if (!pending_) return;  // Bullet also calls for empty groups
  pending_ = false;
  const DofVector after_dynamics = bullet_velocity();
  joints_.solve(before_, after_dynamics, torque_);
  if (!joints_.velocity().allFinite()) {
    finite_ = false;
    set_velocity(DofVector::Zero(before_.size()));
    return;
  }
  if (!factors_.sweeps) {
    points_.clear();
    if (factors_.narrowphase) {
      read_contacts(manifolds, manifold_count);
    } else {
      find_contacts();
    }
    solve_contacts();
    return;
  }
  correction_ = joints_.velocity() - after_dynamics;
  btMultiBodyConstraintSolver::solveMultiBodyGroup(
      bodies, body_count, manifolds, manifold_count, constraints, constraint_count, motor_list_.data(),
      static_cast<int>(motor_list_.size()), info, drawer, dispatcher);
  if (!bullet_velocity().allFinite()) {
    finite_ = false;
    set_velocity(DofVector::Zero(before_.size()));
  }
}

void ConstraintSolver::report(const ContactPoint& point, const Vector3& force,
                              const Vector3& velocity_before) noexcept {
  Contact contact;
  contact.body = point.link + 1;
  contact.leg = point.leg;
  contact.p_WP = point.p_WP;
  contact.normal = point.normal;
  contact.distance = point.distance;
  contact.force = force;
  contact.slip_speed = (velocity_before - point.normal * point.normal.dot(velocity_before)).norm();
  contacts_.add(contact);
}

}  // namespace crossgait::bullet
