// Dry friction in joints: rows of one joint's velocity with a bounded impulse, solved along with the
// contacts. MuJoCo's give way like a damper until they reach the bound (MuJoCo 2.2 manual, "Computation >
// Constraint model > Friction loss"); Bullet's stop the joint at once.
#include "crossgait/backends/bullet/constraint_solver.h"

namespace crossgait::bullet {

// After assemble_contacts, whose rows they see.
void ConstraintSolver::assemble_joint_friction() noexcept {
  const Eigen::Index n = joint_friction_.count, contact_rows = 3 * points_.count;
  for (Eigen::Index i = 0; i < n; ++i) {
    const FrictionalJoint& joint = frictional_joints_[static_cast<std::size_t>(i)];
    const Eigen::Index dof = 6 + joint.link;
    joint_rows_.col(i).setZero();
    joint_rows_(dof, i) = 1;
    respond(i, joint_rows_, projected_joints_);
    joint_friction_.A.col(i).head(n).setZero();
    double target = 0;
    if (!factors_.hard_joint_friction) {
      const double imp = friction_law_.impedance(0);  // nothing is violated
      joint_friction_.A(i, i) = SoftLaw::regularization(imp, joint.inverse_weight);
      target = friction_law_.target_velocity(before_[dof], imp, 0);
    }
    joint_friction_.bound[i] = spec_.physics_dt * joint.friction;
    joint_friction_.b[i] = joints_.velocity()[dof] - target;
  }
  joint_friction_.A.topLeftCorner(n, n).noalias() += joint_rows_.transpose() * projected_joints_;
  joint_friction_.C.topLeftCorner(n, contact_rows).noalias() =
      projected_joints_.transpose() * rows_.leftCols(contact_rows);
}

void ConstraintSolver::add_joint_friction(DofVector& change) const noexcept {
  change.noalias() += projected_joints_ * joint_friction_.x.head(joint_friction_.count);
}

JointVector ConstraintSolver::joint_friction() const {
  JointVector friction = JointVector::Zero(torque_.size());
  for (const FrictionalJoint& joint : frictional_joints_) friction[joint.link] = joint.friction;
  return friction;
}

// What Bullet makes of friction in a joint: a motor that wants it at rest. (No world ever holds them, which
// would leave out those of a robot without colliders.)
void ConstraintSolver::make_friction_motors() {
  for (const FrictionalJoint& joint : frictional_joints_) {
    friction_motors_.push_back(std::make_unique<btMultiBodyJointMotor>(&model_.body(), joint.link, 0,
                                                                       spec_.physics_dt * joint.friction));
    friction_motors_.back()->finalizeMultiDof();
    motor_list_.push_back(friction_motors_.back().get());
  }
}

}  // namespace crossgait::bullet
