#include "physics/core/heading.h"

namespace crossgait {
namespace {

// The axis x that q turns, seen from above; its length is the cosine of the pitch.
Eigen::Vector2d x_over_ground(const Quaternion& q) noexcept {
  return {1 - 2 * (q.y() * q.y() + q.z() * q.z()), 2 * (q.w() * q.z() + q.x() * q.y())};
}

}  // namespace

double yaw_of(const Quaternion& q) noexcept {
  const Eigen::Vector2d x = x_over_ground(q);
  return std::atan2(x.y(), x.x());
}

Heading::Heading(const Quaternion& q) noexcept {
  const Eigen::Vector2d x = x_over_ground(q);
  const double length = x.norm();
  if (length == 0) return;  // it faces straight up or down: yaw_of says 0
  c_ = x.x() / length;
  s_ = x.y() / length;
}

}  // namespace crossgait
