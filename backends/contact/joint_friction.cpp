// Dry friction in joints: rows of one joint's velocity with a bounded impulse, solved along with the
// contacts. MuJoCo's give way like a damper until they reach the bound (MuJoCo 2.2 manual, "Computation >
// Constraint model > Friction loss"); those of hard engines stop the joint at once.
#include "crossgait/backends/contact/contact_stage.h"
#include "crossgait/physics/multibody.h"

namespace crossgait::contact {

std::vector<FrictionalJoint> frictional_joints(const WorldSpec& spec) {
  const JointVector inverse_weights = joint_inverse_weights(*spec.robot, spec.fixed_base);
  std::vector<FrictionalJoint> joints;
  for (int i = 0; i < spec.robot->joint_count(); ++i) {
    const double friction = spec.robot->joint(i).friction;
    if (friction > 0) joints.push_back({i, friction, inverse_weights[i]});
  }
  return joints;
}

// After assemble, whose rows they see.
void ContactStage::assemble_joint_friction(const DofVector& before) noexcept {
  const Eigen::Index n = joint_friction_.count, contact_rows = 3 * cone_.contacts;
  for (Eigen::Index i = 0; i < n; ++i) {
    const FrictionalJoint& joint = frictional_joints_[static_cast<std::size_t>(i)];
    const Eigen::Index dof = 6 + joint.joint;
    joint_rows_.col(i).setZero();
    joint_rows_(dof, i) = 1;
    respond(i, joint_rows_, projected_joints_);
    joint_friction_.A.col(i).head(n).setZero();
    double target = 0;
    if (!factors_.hard_joint_friction) {
      const double imp = friction_law_.impedance(0);  // nothing is violated
      joint_friction_.A(i, i) = SoftLaw::regularization(imp, joint.inverse_weight);
      target = friction_law_.target_velocity(before[dof], imp, 0);
    }
    joint_friction_.bound[i] = spec_.physics_dt * joint.friction;
    joint_friction_.b[i] = joints_.velocity()[dof] - target;
  }
  joint_friction_.A.topLeftCorner(n, n).noalias() += joint_rows_.transpose() * projected_joints_;
  joint_friction_.C.topLeftCorner(n, contact_rows).noalias() =
      projected_joints_.transpose() * rows_.leftCols(contact_rows);
}

void ContactStage::add_joint_friction(DofVector& change) const noexcept {
  change.noalias() += projected_joints_ * joint_friction_.x.head(joint_friction_.count);
}

}  // namespace crossgait::contact
