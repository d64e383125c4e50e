#include "backends/physx/contact_shapes.h"

#include <algorithm>

#include <geomutils/PxContactBuffer.h>

#include "backends/physx/convert.h"

namespace crossgait::physx {
namespace {

/// Features of one shape, in its own frame.
std::vector<contact::BodyFeature> features_of(const RobotDescription& robot, int body, int shape) {
  std::vector<contact::BodyFeature> features;
  for (const ContactFeature& feature : contact_features(robot, false)) {
    if (feature.body == body && feature.shape == shape)
      features.push_back({feature, feature.p_GC, feature.axis_G});
  }
  return features;
}

}  // namespace

FeatureGeometry::FeatureGeometry(const RobotDescription& robot, int body, int shape, const Terrain& terrain,
                                 double margin, const Vector3& origin)
    : origin_(&origin),
      kinematics_{{},
                  [this](int, const Vector3& p_GP) { return Vector3(X_WG_ * p_GP); },
                  [this](int, const Vector3& v_G) { return Vector3(X_WG_.linear() * v_G); },
                  {}},
      finder_(features_of(robot, body, shape), terrain,
              std::vector<double>(static_cast<std::size_t>(body) + 1, margin)) {
  double reach = 0;
  for (const contact::BodyFeature& of : finder_.features())
    reach = std::max(reach, crossgait::reach(of.feature));
  bounds_ = px::PxBounds3::centerExtents(px::PxVec3(0), px::PxVec3(static_cast<float>(reach)));
}

bool FeatureGeometry::touch(const px::PxTransform& X_WG, bool ground_first,
                            px::PxContactBuffer& contacts) const {
  X_WG_ = pose(X_WG);
  X_WG_.translation() += *origin_;
  points_.clear();
  finder_.find(kinematics_, points_);
  for (const contact::ContactPoint& point : points_) {
    const Vector3 normal = ground_first ? Vector3(-point.normal) : point.normal;
    contacts.contact(vector(Vector3(point.p_WP - *origin_)), vector(normal),
                     static_cast<float>(point.distance));
  }
  return points_.count > 0;
}

bool FeatureGeometry::generateContacts(const px::PxGeometry& /*geom0*/, const px::PxGeometry& /*geom1*/,
                                       const px::PxTransform& pose0, const px::PxTransform& /*pose1*/,
                                       px::PxReal /*distance*/, px::PxReal /*margin*/, px::PxReal /*length*/,
                                       px::PxContactBuffer& contacts) const {
  return touch(pose0, false, contacts);
}

FieldGeometry::FieldGeometry(const Terrain& terrain) {
  const HeightField& field = *terrain.field();
  // Whatever is below the field is inside of it.
  constexpr double kDeep = 1e3;  // m
  bounds_ = px::PxBounds3(vector(Vector3(-field.size_x() / 2, -field.size_y() / 2, -kDeep)),
                          vector(Vector3(field.size_x() / 2, field.size_y() / 2, field.max())));
}

bool FieldGeometry::generateContacts(const px::PxGeometry& /*geom0*/, const px::PxGeometry& geom1,
                                     const px::PxTransform& /*pose0*/, const px::PxTransform& pose1,
                                     px::PxReal /*distance*/, px::PxReal /*margin*/, px::PxReal /*length*/,
                                     px::PxContactBuffer& contacts) const {
  const auto& shape = static_cast<const px::PxCustomGeometry&>(geom1);
  return static_cast<const FeatureGeometry&>(*shape.callbacks).touch(pose1, true, contacts);
}

}  // namespace crossgait::physx
