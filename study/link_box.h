// How large a link is, however its file has turned the link's frame.
#pragma once

#include <vector>

#include "physics/robot/robot.h"

namespace crossgait {

/// Holds balls of which a body's outline is the convex hull.
class LinkOutline {
 public:
  /// Adds a collision shape, exactly but for a cylinder, whose rims are polygons of 16 corners.
  void add(const CollisionShape& shape);
  /// Adds a point of the link: its joint, what hangs on it, its foot.
  void add(const Vector3& point) { balls_.push_back({point, 0}); }

  /// Returns the largest distance between two of its points, m; 0 of nothing.
  double length() const noexcept;

 private:
  friend class LinkBox;
  struct Ball {
    Vector3 centre;
    double radius;
  };
  std::vector<Ball> balls_;
};

/// Describes a box around an outline, along the principal axes of its balls: it turns with them.
class LinkBox {
 public:
  explicit LinkBox(const LinkOutline& outline);

  /// Returns lengths of the sides, m.
  Vector3 sizes() const noexcept { return box_.isEmpty() ? Vector3(Vector3::Zero()) : Vector3(box_.sizes()); }
  /// Returns a point's place from the middle along the sides, m.
  Vector3 from_middle(const Vector3& point) const noexcept { return axes_ * point - box_.center(); }

 private:
  Matrix3 axes_ = Matrix3::Identity();  // in rows
  Eigen::AlignedBox3d box_;             // in these axes
};

}  // namespace crossgait
