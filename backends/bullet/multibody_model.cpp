#include "backends/bullet/multibody_model.h"

#include "backends/bullet/convert.h"
#include "physics/robot/principal_inertia.h"

namespace crossgait::bullet {
namespace {

void set_up_link(btMultiBody& body, int link, const Body& own, const Pose& X_parent, const Pose& X_own,
                 const Vector3& moments) {
  // Pose of the own principal axes in the parent's at zero angle; Bullet wants the rotation the other way
  // round.
  const Matrix3 R_ParentOwn = X_parent.linear().transpose() * own.X_PB.linear() * X_own.linear();
  const Quaternion parent_to_this(Matrix3(R_ParentOwn.transpose()));
  const Vector3 axis = X_own.linear().transpose() * own.joint.axis;
  const Vector3 com_to_pivot =
      X_parent.linear().transpose() * (own.X_PB.translation() - X_parent.translation());
  const Vector3 pivot_to_com = X_own.linear().transpose() * X_own.translation();
  body.setupRevolute(link, own.inertia.mass, vector(moments), own.parent - 1, quaternion(parent_to_this),
                     vector(axis), vector(com_to_pivot), vector(pivot_to_com), true);
}

// Bullet's defaults damp, clamp and put to sleep; none of that is physics.
void remove_artefacts(btMultiBody& body) {
  body.setLinearDamping(0);
  body.setAngularDamping(0);
  body.setUseGyroTerm(true);
  body.useGlobalVelocities(false);
  body.useRK4Integration(false);
  body.setMaxCoordinateVelocity(1e10);
  body.setMaxAppliedImpulse(1e10);
  body.setHasSelfCollision(false);
  body.setCanSleep(false);
}

}  // namespace

MultibodyModel::MultibodyModel(const WorldSpec& spec) : spec_(spec) {
  const std::vector<Body>& bodies = spec.robot->bodies;
  std::vector<PrincipalInertia> principal;
  for (const Body& b : bodies) {
    principal.push_back(principal_inertia(b.inertia));
    X_BP_.push_back(principal.back().X_BP);
  }
  body_ = std::make_unique<btMultiBody>(spec.robot->joint_count(), bodies[0].inertia.mass,
                                        vector(principal[0].moments), spec.fixed_base, false);
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    const std::size_t parent = static_cast<std::size_t>(bodies[i].parent);
    set_up_link(*body_, static_cast<int>(i) - 1, bodies[i], X_BP_[parent], X_BP_[i], principal[i].moments);
  }
  remove_artefacts(*body_);
  body_->finalizeMultiDof();
}

std::vector<contact::BodyFeature> MultibodyModel::contact_features() const {
  return contact::body_features(*spec_.robot, spec_.fixed_base, X_BP_);
}

}  // namespace crossgait::bullet
