#include "physics/core/math.h"

#include <algorithm>
#include <cmath>

namespace crossgait {

Vector3 roll_pitch_yaw(const Quaternion& q) {
  const double roll =
      std::atan2(2 * (q.w() * q.x() + q.y() * q.z()), 1 - 2 * (q.x() * q.x() + q.y() * q.y()));
  const double pitch = std::asin(std::clamp(2 * (q.w() * q.y() - q.z() * q.x()), -1.0, 1.0));
  const double yaw = std::atan2(2 * (q.w() * q.z() + q.x() * q.y()), 1 - 2 * (q.y() * q.y() + q.z() * q.z()));
  return {roll, pitch, yaw};
}

Quaternion from_roll_pitch_yaw(double roll, double pitch, double yaw) {
  using Eigen::AngleAxisd;
  return Quaternion(AngleAxisd(yaw, Vector3::UnitZ()) * AngleAxisd(pitch, Vector3::UnitY()) *
                    AngleAxisd(roll, Vector3::UnitX()));
}

// Eigen's FromTwoVectors brings a singular value decomposition, and a quarter of a minute of compilation.
Quaternion rotation_of_z_to(const Vector3& axis) {
  const Vector3 across = Vector3::UnitZ().cross(axis);  // the sine of the angle times its axis
  const double sine = across.norm();
  if (sine == 0) return axis.z() >= 0 ? Quaternion::Identity() : Quaternion(0, 1, 0, 0);
  return Quaternion(Eigen::AngleAxisd(std::atan2(sine, axis.z()), across / sine));
}

}  // namespace crossgait
