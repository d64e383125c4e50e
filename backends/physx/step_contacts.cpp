#include "backends/physx/step_contacts.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "backends/contact/tree_dynamics.h"
#include "backends/physx/convert.h"

namespace crossgait::physx {
namespace {

// PhysX wants a margin of every shape; the ground's is nothing beside the robot's.
constexpr float kGroundOffset = 1e-6F;  // m

/// PhysX's own geometry of a shape that touches the plane where contact_features.h says; else of no type.
px::PxGeometryHolder plane_geometry(const CollisionShape& shape) {
  const auto x = static_cast<float>(shape.size.x()), y = static_cast<float>(shape.size.y());
  if (shape.type == ShapeType::kSphere) return px::PxGeometryHolder(px::PxSphereGeometry(x));
  if (shape.type == ShapeType::kCapsule) return px::PxGeometryHolder(px::PxCapsuleGeometry(x, y));
  if (shape.type == ShapeType::kBox) return px::PxGeometryHolder(px::PxBoxGeometry(vector(shape.size)));
  return {};
}

/// PhysX's capsules lie along x.
Pose geometry_pose(const CollisionShape& shape) {
  Pose X_BG = shape.X_BG;
  if (shape.type == ShapeType::kCapsule)
    X_BG.linear() = X_BG.linear() * Quaternion::FromTwoVectors(Vector3::UnitX(), Vector3::UnitZ()).matrix();
  return X_BG;
}

}  // namespace

// NOLINTBEGIN(performance-unnecessary-value-param): it is PhysX's to say how it calls this
px::PxFilterFlags only_ground(px::PxFilterObjectAttributes a, px::PxFilterData /*data_a*/,
                              px::PxFilterObjectAttributes b, px::PxFilterData /*data_b*/,
                              px::PxPairFlags& flags, const void* /*block*/, px::PxU32 /*size*/) {
  // NOLINTEND(performance-unnecessary-value-param)
  const auto is_ground = [](px::PxFilterObjectAttributes attributes) {
    return px::PxGetFilterObjectType(attributes) == px::PxFilterObjectType::eRIGID_STATIC;
  };
  if (!is_ground(a) && !is_ground(b)) return px::PxFilterFlag::eKILL;
  flags = px::PxPairFlag::eCONTACT_DEFAULT | px::PxPairFlag::eNOTIFY_TOUCH_FOUND |
          px::PxPairFlag::eNOTIFY_TOUCH_PERSISTS | px::PxPairFlag::eNOTIFY_CONTACT_POINTS;
  return px::PxFilterFlag::eDEFAULT;
}

StepContacts::StepContacts(const WorldSpec& spec, const Settings& settings)
    : spec_(spec), margins_(spec.robot->bodies.size(), settings.contact_offset) {
  const RobotDescription& robot = *spec.robot;
  if (!settings.margin)
    margins_ = contact::reach_margins(
        contact::body_features(robot, spec.fixed_base, contact::tree_frames(robot)), robot.bodies.size());
  const auto friction = static_cast<float>(spec.contact.friction);
  material_.reset(the_physics().createMaterial(friction, friction, 0));
  if (material_ == nullptr) throw std::runtime_error("PhysX refused a material");
  forces_.resize(spec.robot->bodies.size());
  loads_.resize(spec.robot->bodies.size());
  if (spec.terrain.field() != nullptr) field_ = std::make_unique<FieldGeometry>(spec.terrain);
}

void StepContacts::build(px::PxScene& scene, const ArticulationModel& model) {
  px::PxPhysics& physics = the_physics();
  // A plane faces along x.
  const px::PxTransform upwards(px::PxQuat(-px::PxHalfPi, px::PxVec3(0, 1, 0)));
  ground_.reset(physics.createRigidStatic(field_ ? px::PxTransform(px::PxIdentity) : upwards));
  px::PxShape* shape = field_ ? physics.createShape(px::PxCustomGeometry(*field_), *material_, true)
                              : physics.createShape(px::PxPlaneGeometry(), *material_, true);
  if (shape == nullptr) throw std::runtime_error("PhysX refused the ground");
  shape->setContactOffset(kGroundOffset);
  ground_->attachShape(*shape);
  shape->release();
  scene.addActor(*ground_);
  const std::vector<Body>& bodies = spec_.robot->bodies;
  for (std::size_t body = spec_.fixed_base ? 1 : 0; body < bodies.size(); ++body) {
    for (std::size_t i = 0; i < bodies[body].shapes.size(); ++i)
      add_shape(model.link(static_cast<int>(body)), model, static_cast<int>(body), static_cast<int>(i));
  }
}

void StepContacts::add_shape(px::PxArticulationLink& link, const ArticulationModel& model, int body,
                             int index) {
  const RobotDescription& robot = *spec_.robot;
  const CollisionShape& described =
      robot.bodies[static_cast<std::size_t>(body)].shapes[static_cast<std::size_t>(index)];
  shapes_.push_back(std::make_unique<Shape>());
  Shape& own = *shapes_.back();
  own.body = body;
  own.leg = leg_of_shape(robot, body, index);
  const double margin = margins_[static_cast<std::size_t>(body)];
  px::PxGeometryHolder geometry;
  Pose X_BG = described.X_BG;
  if (field_ == nullptr) geometry = plane_geometry(described);
  if (geometry.getType() == px::PxGeometryType::eINVALID) {
    own.features = std::make_unique<FeatureGeometry>(robot, body, index, spec_.terrain,
                                                     margin + kGroundOffset, model.origin());
    geometry = px::PxGeometryHolder(px::PxCustomGeometry(*own.features));
  } else {
    X_BG = geometry_pose(described);
  }
  px::PxShape* shape = the_physics().createShape(geometry.any(), *material_, true);
  if (shape == nullptr) throw std::runtime_error("PhysX refused shape " + described.name);
  shape->setContactOffset(static_cast<float>(margin));
  shape->setLocalPose(transform(model.X_BP(body).inverse() * X_BG));
  shape->userData = &own;
  link.attachShape(*shape);
  shape->release();
}

void StepContacts::begin_step(px::PxScene& scene, const ArticulationModel& model) {
  forget();
  // The plane is everywhere.
  const px::PxVec3 place = vector(Vector3(-model.origin()));
  if (field_ && ground_->getGlobalPose().p != place) ground_->setGlobalPose(px::PxTransform(place));
  scene.resetFiltering(*ground_);
}

void StepContacts::forget() noexcept {
  for (const auto& shape : shapes_) {
    shape->count = 0;
    if (shape->features) shape->features->forget();
  }
}

void StepContacts::onContact(const px::PxContactPairHeader& /*header*/, const px::PxContactPair* pairs,
                             px::PxU32 count) {
  for (px::PxU32 i = 0; i < count; ++i) {
    const px::PxContactPair& pair = pairs[i];
    const bool robot_first = pair.shapes[0]->userData != nullptr;
    Shape& shape = *static_cast<Shape*>(pair.shapes[robot_first ? 0 : 1]->userData);
    shape.count = pair.extractContacts(shape.points.data(), static_cast<px::PxU32>(shape.points.size()));
    if (robot_first) continue;
    for (px::PxU32 k = 0; k < shape.count; ++k) {
      shape.points[k].normal = -shape.points[k].normal;
      shape.points[k].impulse = -shape.points[k].impulse;
    }
  }
}

void StepContacts::list(const Shape& shape, const Vector3& origin, ContactList& contacts) const noexcept {
  const auto add = [&](Contact contact, const Vector3& impulse) {
    contact.body = shape.body;
    contact.leg = shape.leg;
    contact.force = contact.normal * impulse.dot(contact.normal) / spec_.physics_dt;
    if (contact.distance <= 0 || contact.force.dot(contact.normal) > 0) contacts.add(contact);
  };
  if (shape.features == nullptr) {
    for (px::PxU32 k = 0; k < shape.count; ++k) {
      const px::PxContactPairPoint& point = shape.points[k];
      Contact contact;
      contact.normal = vector(point.normal);
      contact.distance = point.separation;
      // PhysX's point is on the robot's surface.
      contact.p_WP = origin + (vector(point.position) - contact.distance / 2 * contact.normal);
      add(contact, vector(point.impulse));
    }
    return;
  }
  // Of many points on one patch PhysX solves a few: the others carry nothing.
  for (const contact::ContactPoint& found : shape.features->points()) {
    Contact contact;
    contact.normal = found.normal;
    contact.distance = found.distance;
    contact.p_WP = found.p_WP;
    const px::PxVec3 position = vector(Vector3(found.p_WP - origin));
    px::PxVec3 impulse(0);
    for (px::PxU32 k = 0; k < shape.count; ++k)
      if (shape.points[k].position == position) impulse = shape.points[k].impulse;
    add(contact, vector(impulse));
  }
}

void StepContacts::add_friction(const ArticulationModel& model, const Vector3& push,
                                ContactList& contacts) const noexcept {
  if (contacts.count == 0) return;
  model.contact_forces(push, forces_);
  std::fill(loads_.begin(), loads_.end(), 0);
  for (const Contact& contact : contacts) {
    forces_[model.group(contact.body)] -= contact.force;
    loads_[model.group(contact.body)] += contact.force.norm();
  }
  for (int i = 0; i < contacts.count; ++i) {
    Contact& contact = contacts.points[static_cast<std::size_t>(i)];
    const std::size_t group = model.group(contact.body);
    if (loads_[group] == 0) continue;
    const Vector3& rest = forces_[group];
    contact.force +=
        contact.force.norm() / loads_[group] * (rest - contact.normal * contact.normal.dot(rest));
  }
}

void StepContacts::read(const ArticulationModel& model, const Vector3& push,
                        ContactList& contacts) const noexcept {
  for (const auto& shape : shapes_) list(*shape, model.origin(), contacts);
  add_friction(model, push, contacts);
  for (int i = 0; i < contacts.count; ++i) {
    Contact& contact = contacts.points[static_cast<std::size_t>(i)];
    const px::PxSpatialVelocity& before = model.velocity_before(contact.body);
    const Vector3 lever = contact.p_WP - model.origin() - vector(model.link(contact.body).getGlobalPose().p);
    const Vector3 v = vector(before.linear) + vector(before.angular).cross(lever);
    contact.slip_speed = (v - contact.normal * contact.normal.dot(v)).norm();
  }
}

}  // namespace crossgait::physx
