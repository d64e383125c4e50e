#include "physics/robot/shape_box.h"

namespace crossgait {

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

}  // namespace crossgait
