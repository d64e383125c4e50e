#include "physics/robot_files/mesh/mesh_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "physics/robot_files/mesh/convex_hull.h"

namespace crossgait {
namespace {

/// Half the least thickness of a box or capsule around a mesh, m: meshes of plates are often flat.
constexpr double kThinnestHalf = 1e-4;
/// Of the hull's volume: how much a box or capsule may have.
constexpr double kLargestVolume = 1.25;
/// Of the hull whose volume counts: a ball's is found to 3 %.
constexpr int kVolumeVertices = 200;

struct Capsule {
  Eigen::Index axis = 0;
  double radius = 0, half_length = kThinnestHalf;  // m
  double volume() const { return std::numbers::pi * radius * radius * (2 * half_length + 4 * radius / 3); }
};

Capsule capsule_around(const std::vector<Vector3>& vertices, const Vector3& centre, const Vector3& half) {
  Capsule capsule;
  half.maxCoeff(&capsule.axis);
  const auto along = [&](const Vector3& v) { return std::abs(v[capsule.axis] - centre[capsule.axis]); };
  const auto across_squared = [&](const Vector3& v) {
    return std::max(0.0, (v - centre).squaredNorm() - along(v) * along(v));
  };
  double square = kThinnestHalf * kThinnestHalf;
  for (const Vector3& v : vertices) square = std::max(square, across_squared(v));
  capsule.radius = std::sqrt(square);
  for (const Vector3& v : vertices) {
    capsule.half_length = std::max(capsule.half_length, along(v) - std::sqrt(square - across_squared(v)));
  }
  return capsule;
}

}  // namespace

void fit_mesh(const std::vector<Vector3>& vertices, CollisionShape& shape) {
  Vector3 low = vertices.front(), high = low;
  for (const Vector3& vertex : vertices) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  const Vector3 centre = (low + high) / 2, half = ((high - low) / 2).cwiseMax(kThinnestHalf);
  shape.X_BG = shape.X_BG * Eigen::Translation3d(centre);
  const ConvexHull hull = convex_hull(vertices, kVolumeVertices);
  const Capsule capsule = capsule_around(vertices, centre, half);
  const double box_volume = 8 * half.prod(), capsule_volume = capsule.volume();
  const bool simple = std::min(box_volume, capsule_volume) <= kLargestVolume * hull.volume;
  if (hull.volume == 0 || (simple && box_volume <= capsule_volume)) {
    shape.type = ShapeType::kBox;
    shape.size = half;
  } else if (simple) {
    shape.type = ShapeType::kCapsule;
    shape.size = {capsule.radius, capsule.half_length, 0};
    Matrix3 R;
    for (const Eigen::Index k : {0, 1, 2}) R.col(k) = Vector3::Unit((capsule.axis + 1 + k) % 3);
    shape.X_BG.linear() = shape.X_BG.linear() * R;
  } else {
    shape.type = ShapeType::kHull;
    const auto count = std::min<std::size_t>(hull.vertices.size(), kMaxHullVertices);
    for (std::size_t i = 0; i < count; ++i) shape.vertices.push_back(hull.vertices[i] - centre);
  }
}

}  // namespace crossgait
