#include "crossgait/backends/bullet/multibody_model.h"

#include "crossgait/backends/bullet/convert.h"
#include "crossgait/physics/multibody.h"
#include "crossgait/physics/principal_inertia.h"

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

SphereCentres LinkFeature::centres(const btMultiBody& body, const Terrain& terrain,
                                   double margin) const noexcept {
  const Vector3 p_WF = vector(body.localPosToWorld(link, vector(p_CF)));
  const Vector3 axis_W = feature.rim > 0 ? vector(body.localDirToWorld(link, vector(axis_C))) : axis_C;
  return sphere_centres(feature, p_WF, axis_W, terrain, margin);
}

MultibodyModel::MultibodyModel(const WorldSpec& spec)
    : spec_(spec), inverse_weights_(translational_inverse_weights(*spec.robot, spec.fixed_base)) {
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

JointVector MultibodyModel::armature() const {
  JointVector armature(spec_.robot->joint_count());
  for (int i = 0; i < spec_.robot->joint_count(); ++i) armature[i] = spec_.robot->joint(i).armature;
  return armature;
}

std::vector<FrictionalJoint> MultibodyModel::frictional_joints() const {
  const JointVector inverse_weights = joint_inverse_weights(*spec_.robot, spec_.fixed_base);
  std::vector<FrictionalJoint> joints;
  for (int i = 0; i < spec_.robot->joint_count(); ++i) {
    const double friction = spec_.robot->joint(i).friction;
    if (friction > 0) joints.push_back({i, friction, inverse_weights[i]});
  }
  return joints;
}

std::vector<LoopPoints> MultibodyModel::loop_points() const {
  std::vector<LoopPoints> loops;
  for (const LoopClosure& loop : spec_.robot->loops) {
    const auto a = static_cast<std::size_t>(loop.body_a), b = static_cast<std::size_t>(loop.body_b);
    loops.push_back({loop.body_a - 1, loop.body_b - 1, X_BP_[a].inverse() * loop.p_AP,
                     X_BP_[b].inverse() * loop.p_BP, inverse_weights_[a] + inverse_weights_[b]});
  }
  return loops;
}

std::vector<LinkFeature> MultibodyModel::contact_features() const {
  std::vector<LinkFeature> features;
  for (const ContactFeature& feature : crossgait::contact_features(*spec_.robot, spec_.fixed_base)) {
    const auto b = static_cast<std::size_t>(feature.body);
    const Pose& X_BG = spec_.robot->bodies[b].shapes[static_cast<std::size_t>(feature.shape)].X_BG;
    const Pose X_CB = X_BP_[b].inverse();
    features.push_back({feature, feature.body - 1, X_CB * (X_BG * feature.p_GC),
                        X_CB.linear() * X_BG.linear() * feature.axis_G});
  }
  return features;
}

}  // namespace crossgait::bullet
