// Where something faces on the ground.
#pragma once

#include <cmath>

#include "physics/core/math.h"

namespace crossgait {

/// Solves q = Rz(yaw) Ry(pitch) Rx(roll) for yaw alone, rad.
double yaw_of(const Quaternion& q) noexcept;

/// Holds a yaw by its cosine and sine.
class Heading {
 public:
  Heading() = default;                                                             ///< along x of W
  explicit Heading(double yaw) noexcept : c_(std::cos(yaw)), s_(std::sin(yaw)) {}  ///< rad
  /// Has the yaw of `yaw_of`, without asking for the angle.
  explicit Heading(const Quaternion& q) noexcept;

  /// Returns the heading that lies `angle` (rad) further to the left.
  Heading turned(double angle) const noexcept {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * c_ - s * s_, s * c_ + c * s_};
  }
  /// Returns a vector's components forward, to the left and up.
  Vector3 components(const Vector3& v_W) const noexcept {
    return {c_ * v_W.x() + s_ * v_W.y(), c_ * v_W.y() - s_ * v_W.x(), v_W.z()};
  }

 private:
  Heading(double c, double s) noexcept : c_(c), s_(s) {}

  double c_ = 1, s_ = 0;
};

}  // namespace crossgait
