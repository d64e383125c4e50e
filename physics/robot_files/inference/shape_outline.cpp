#include "physics/robot_files/inference/shape_outline.h"

#include <algorithm>
#include <cmath>

namespace crossgait {

std::array<Vector3, 2> ends_of(const CollisionShape& shape) {
  return {shape.X_BG * Vector3(0, 0, -shape.size[1]), shape.X_BG * Vector3(0, 0, shape.size[1])};
}

std::vector<Vector3> outline_of(const ParsedRobot& robot, const CollisionShape& shape) {
  if (const auto mesh = robot.mesh_vertices.find(shape.name); mesh != robot.mesh_vertices.end())
    return mesh->second;
  std::vector<Vector3> points;
  if (shape.type == ShapeType::kSphere) {
    points.emplace_back(shape.X_BG.translation());
  } else if (shape.type == ShapeType::kCylinder || shape.type == ShapeType::kCapsule) {
    for (const Vector3& end : ends_of(shape)) points.push_back(end);
  } else if (shape.type == ShapeType::kHull) {
    for (const Vector3& vertex : shape.vertices) points.push_back(shape.X_BG * vertex);
  } else {
    for (int corner = 0; corner < 8; ++corner) {
      const auto sign = [corner](int bit) { return (corner >> bit & 1) != 0 ? 1.0 : -1.0; };
      points.push_back(shape.X_BG * Vector3(sign(0), sign(1), sign(2)).cwiseProduct(shape.size));
    }
  }
  return points;
}

double rounding_of(const ParsedRobot& robot, const CollisionShape& shape) {
  const bool is_flat = shape.type == ShapeType::kBox || shape.type == ShapeType::kHull;
  return is_flat || robot.mesh_vertices.contains(shape.name) ? 0 : shape.size[0];
}

double reach_of(const ParsedRobot& robot, const CollisionShape& shape, const Vector3& point,
                const Vector3& direction) {
  // The rim of a cylinder is flat: nothing of it reaches along its axis.
  const bool has_rim = shape.type == ShapeType::kCylinder && !robot.mesh_vertices.contains(shape.name);
  const double along = has_rim ? direction.dot(shape.X_BG.linear().col(2)) : 0,
               rounding = rounding_of(robot, shape) * std::sqrt(std::max(0.0, 1 - along * along));
  double reach = 0;
  for (const Vector3& p : outline_of(robot, shape))
    reach = std::max(reach, std::abs(direction.dot(p - point)) + rounding);
  return reach;
}

}  // namespace crossgait
