#include "crossgait/backends/bullet/multibody_model.h"

#include <cmath>
#include <numbers>

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

// Points of the shape's surface that stand for it, in its frame.
std::vector<Vector3> contact_points(const CollisionShape& shape) {
  std::vector<Vector3> points;
  switch (shape.type) {
    case ShapeType::kSphere:
      points.push_back(Vector3::Zero());
      break;
    case ShapeType::kBox:
      for (int corner = 0; corner < 8; ++corner) {
        const Vector3 sign((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1,
                           (corner & 4) != 0 ? 1 : -1);
        points.emplace_back(sign.cwiseProduct(shape.size));
      }
      break;
    case ShapeType::kCylinder: {
      constexpr int kSides = 16;  // rolls on flats that lie 2 % of the radius below its round
      for (int side = 0; side < kSides; ++side) {
        const double angle = 2 * std::numbers::pi * side / kSides;
        const double x = shape.size.x() * std::cos(angle), y = shape.size.x() * std::sin(angle);
        points.emplace_back(x, y, -shape.size.y());
        points.emplace_back(x, y, shape.size.y());
      }
      break;
    }
  }
  return points;
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

std::vector<ContactSphere> MultibodyModel::spheres() const {
  std::vector<ContactSphere> spheres;
  const std::vector<Body>& bodies = spec_.robot->bodies;
  for (std::size_t b = spec_.fixed_base ? 1 : 0; b < bodies.size(); ++b) {
    for (std::size_t k = 0; k < bodies[b].shapes.size(); ++k) {
      const CollisionShape& shape = bodies[b].shapes[k];
      const int body = static_cast<int>(b), leg = leg_of_shape(*spec_.robot, body, static_cast<int>(k));
      const double radius = shape.type == ShapeType::kSphere ? shape.size.x() : 0;
      for (const Vector3& point : contact_points(shape)) {
        spheres.push_back({body - 1, leg, X_BP_[b].inverse() * (shape.X_BG * point), radius});
      }
    }
  }
  return spheres;
}

}  // namespace crossgait::bullet
