#include "physics/engine/contact_features.h"

#include <numbers>

namespace crossgait {
namespace {

/// Below this sine of the angle between axis and normal, a rim's nearest point is rounding error.
constexpr double kUpright = 1e-9;

Vector3 corner_of(const Vector3& half_extents, int corner) {
  const Vector3 sign((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
  return sign.cwiseProduct(half_extents);
}

/// @param feature  of which shape they are
void add_features(const CollisionShape& shape, ContactFeature feature,
                  std::vector<ContactFeature>& features) {
  const auto add_at = [&](const Vector3& p_GC) {
    feature.p_GC = p_GC;
    features.push_back(feature);
  };
  switch (shape.type) {
    case ShapeType::kSphere:
      feature.radius = shape.size.x();
      add_at(Vector3::Zero());
      break;
    case ShapeType::kBox:
      for (int corner = 0; corner < 8; ++corner) add_at(corner_of(shape.size, corner));
      break;
    case ShapeType::kCylinder:
    case ShapeType::kCapsule:
      (shape.type == ShapeType::kCylinder ? feature.rim : feature.radius) = shape.size.x();
      for (const double side : {-1.0, 1.0}) add_at({0, 0, side * shape.size.y()});
      break;
    case ShapeType::kHull:
      for (const Vector3& vertex : shape.vertices) add_at(vertex);
      break;
  }
}

}  // namespace

std::vector<ContactFeature> contact_features(const RobotDescription& robot, bool fixed_base) {
  std::vector<ContactFeature> features;
  for (std::size_t b = fixed_base ? 1 : 0; b < robot.bodies.size(); ++b) {
    const std::vector<CollisionShape>& shapes = robot.bodies[b].shapes;
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      ContactFeature feature;
      feature.body = static_cast<int>(b);
      feature.shape = static_cast<int>(k);
      feature.leg = leg_of_shape(robot, feature.body, feature.shape);
      add_features(shapes[k], feature, features);
    }
  }
  return features;
}

std::vector<ContactFeature> features_of(const CollisionShape& shape) {
  std::vector<ContactFeature> features;
  add_features(shape, {}, features);
  return features;
}

int feature_count(const CollisionShape& shape) { return static_cast<int>(features_of(shape).size()); }

int most_contact_points(const RobotDescription& robot, bool fixed_base) {
  int points = 0;
  for (const ContactFeature& feature : contact_features(robot, fixed_base)) points += feature.rim > 0 ? 3 : 1;
  return points;
}

SphereCentres sphere_centres(const ContactFeature& feature, const Vector3& centre, const Vector3& axis,
                             const Terrain& terrain, double margin) noexcept {
  SphereCentres centres;
  if (feature.rim == 0) {
    centres.points[0] = centre;
    centres.count = 1;
    return centres;
  }
  SphereContact nearest;
  if (!terrain.touch_sphere(centre, feature.rim + feature.radius + margin, nearest)) return centres;
  const Vector3 down =
      axis.cross(axis.cross(nearest.normal));  // what the axis leaves of -normal, also of a little
  const double sine = down.norm();
  const Vector3 first = feature.rim * (sine > kUpright ? Vector3(down / sine) : axis.unitOrthogonal());
  const Vector3 aside = std::numbers::sqrt3 / 2 * axis.cross(first);
  centres.points = {centre + first, centre - first / 2 + aside, centre - first / 2 - aside};
  centres.count = 3;
  return centres;
}

}  // namespace crossgait
