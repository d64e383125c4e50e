// Where a robot can touch the ground: the same few places in every engine.
#pragma once

#include <array>
#include <vector>

#include "physics/robot/robot.h"
#include "physics/terrain/terrain.h"

namespace crossgait {

/// Is a sphere of a shape (a corner or a vertex is one without radius), or a circle on which spheres sit.
///
/// | shape | features |
/// |---|---|
/// | sphere | itself |
/// | capsule | the spheres at its two ends |
/// | box | its eight corners |
/// | cylinder | its two rims |
/// | hull | its vertices |
///
/// Of a rim three points can touch (`sphere_centres`). Between its features a shape feels no ground: a bump
/// narrower than a box passes through its face.
struct ContactFeature {
  int body = 0, shape = 0;            ///< indices into RobotDescription::bodies and Body::shapes
  int leg = -1;                       ///< of whose foot it is, or -1
  Vector3 p_GC = Vector3::Zero();     ///< centre of the sphere or rim in the shape's frame, m
  Vector3 axis_G = Vector3::UnitZ();  ///< of the rim, unit, in the shape's frame
  double rim = 0;                     ///< radius of the rim, m; 0: a single sphere
  double radius = 0;                  ///< of the sphere, or of those on the rim, m
};

/// Lists the features of every shape of all bodies that can move, in the order of bodies and shapes.
std::vector<ContactFeature> contact_features(const RobotDescription& robot, bool fixed_base);

/// Lists the features of one shape, whose body and place are not known.
std::vector<ContactFeature> features_of(const CollisionShape& shape);

/// Counts a shape's features.
int feature_count(const CollisionShape& shape);

/// Counts the points that can touch at once, of all shapes: three of a rim, one of every other feature.
int most_contact_points(const RobotDescription& robot, bool fixed_base);

/// Returns how far from the shape's origin a feature reaches, m.
inline double reach(const ContactFeature& feature) {
  return feature.p_GC.norm() + feature.rim + feature.radius;
}

/// Holds centres of the spheres of one feature that may touch.
struct SphereCentres {
  std::array<Vector3, 3> points;
  int count = 0;
};

/// Places the spheres of a feature: of a sphere its centre. Of a rim the point nearest to the ground and the
/// two a third of a turn from it: one point where a cylinder lies or tips, three where it stands (as MuJoCo
/// has a cylinder touch a plane). "Nearest" is meant along the normal of the ground's point closest to the
/// rim's centre (`Terrain::touch_sphere`); an upright rim begins anywhere.
/// @param centre,axis  of the feature, in W
/// @param margin  of points that are to be found above the ground, m
/// @returns none where no point of the rim is within reach of the ground
SphereCentres sphere_centres(const ContactFeature& feature, const Vector3& centre, const Vector3& axis,
                             const Terrain& terrain, double margin) noexcept;

}  // namespace crossgait
