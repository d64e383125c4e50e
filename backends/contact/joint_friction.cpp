#include "backends/contact/joint_friction.h"

#include "physics/robot/multibody.h"

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

FrictionRow friction_row(const FrictionalJoint& joint, const SoftLaw& law, bool hard, double speed) noexcept {
  if (hard) return {};
  const double imp = law.impedance(0);  // nothing is violated
  return {SoftLaw::regularization(imp, joint.inverse_weight), law.target_velocity(speed, imp, 0)};
}

}  // namespace crossgait::contact
