#include "physics/robot_files/inertia_repair.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "physics/robot/robot_check.h"

namespace crossgait {
namespace {

/// By which a raised moment exceeds what it has to be: a flat or thin body at the very limit is refused by
/// engines when its principal moments are rounded.
constexpr double kMargin = 1e-3;
/// As in check_inertia.
constexpr double kTriangleRounding = 1e-9;
constexpr double kLeastGyration = 1e-6;  // m; less is the rounding of zeros that were turned
constexpr double kWater = 1000;          // kg/m^3

/// The box along the axes of its body that holds a shape.
Eigen::AlignedBox3d box_around(const CollisionShape& shape) {
  const Matrix3 R = shape.X_BG.linear();
  const Vector3 axis = R.col(2);
  Eigen::AlignedBox3d box;
  Vector3 half = Vector3::Zero();
  switch (shape.type) {
    case ShapeType::kSphere:
      half.setConstant(shape.size[0]);
      break;
    case ShapeType::kCylinder: {
      const Vector3 across = (Vector3::Ones() - axis.cwiseAbs2()).cwiseMax(0).cwiseSqrt();
      half = shape.size[1] * axis.cwiseAbs() + shape.size[0] * across;
      break;
    }
    case ShapeType::kCapsule:
      half = shape.size[1] * axis.cwiseAbs() + Vector3::Constant(shape.size[0]);
      break;
    case ShapeType::kBox:
      half = R.cwiseAbs() * shape.size;
      break;
    case ShapeType::kHull:
      for (const Vector3& vertex : shape.vertices) box.extend(shape.X_BG * vertex);
      return box;
  }
  const Vector3 centre = shape.X_BG.translation();
  return {centre - half, centre + half};
}

/// Edges of the box along the body's axes that holds all shapes, m.
Vector3 bounding_box(const std::vector<CollisionShape>& shapes) {
  Eigen::AlignedBox3d box;
  for (const CollisionShape& shape : shapes) box.extend(box_around(shape));
  return box.sizes();
}

std::string_view invent(SpatialInertia& inertia, const std::vector<CollisionShape>& shapes) {
  if (shapes.empty()) {
    const double radius = std::cbrt(3 * inertia.mass / (4 * std::numbers::pi * kWater));
    inertia.I_C = 0.4 * inertia.mass * radius * radius * Matrix3::Identity();
    return "without inertia or shapes, given that of a solid sphere of water: ";
  }
  const Vector3 squares = bounding_box(shapes).cwiseAbs2();
  inertia.I_C = (inertia.mass / 12 * (Vector3::Constant(squares.sum()) - squares)).asDiagonal();
  return "without inertia, given that of the bounding box of their shapes: ";
}

}  // namespace

std::string_view repair_inertia(SpatialInertia& inertia, const std::vector<CollisionShape>& shapes) {
  if (inertia.I_C.cwiseAbs().maxCoeff() < inertia.mass * kLeastGyration * kLeastGyration) {
    return invent(inertia, shapes);
  }
  if (!inertia.I_C.allFinite() || inertia.I_C.cwiseAbs().maxCoeff() > kLargestInertia) return {};
  const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(inertia.I_C);
  const Vector3& before = eigen.eigenvalues();  // rising
  const double largest = before[2];
  const bool possible = before[0] > 0 && largest <= (before[0] + before[1]) * (1 + kTriangleRounding);
  if (possible || largest <= 0) return {};
  // The smallest first, up to the middle one, and then both: the least that has to be added.
  const double needed = largest * (1 + kMargin);
  Vector3 after = before;
  after[1] = std::max(before[1], needed / 2);
  after[0] = std::max(before[0], needed - after[1]);
  const Matrix3& R = eigen.eigenvectors();
  inertia.I_C = R * after.asDiagonal() * R.transpose();
  inertia.I_C = 0.5 * (inertia.I_C + inertia.I_C.transpose()).eval();
  return "whose small principal moments are raised to what a real body has: ";
}

}  // namespace crossgait
