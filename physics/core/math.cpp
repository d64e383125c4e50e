#include "physics/core/math.h"

#include <algorithm>
#include <cmath>

#include "physics/core/heading.h"

namespace crossgait {

Vector3 roll_pitch_yaw(const Quaternion& q) {
  const double roll =
      std::atan2(2 * (q.w() * q.x() + q.y() * q.z()), 1 - 2 * (q.x() * q.x() + q.y() * q.y()));
  const double pitch = std::asin(std::clamp(2 * (q.w() * q.y() - q.z() * q.x()), -1.0, 1.0));
  return {roll, pitch, yaw_of(q)};
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

double levelling_angle(const Vector3& axis, const Vector3& v) {
  // Rodrigues: z of v turned is A cos + B sin + C.
  const double C = axis.dot(v) * axis.z(), A = v.z() - C, B = axis.cross(v).z(), size = std::hypot(A, B);
  if (size < 1e-9) return 0;  // it stays where it is
  const double middle = std::atan2(B, A), half = std::acos(std::clamp(-C / size, -1.0, 1.0));
  const double a = wrapped(middle + half), b = wrapped(middle - half);
  return std::abs(a) < std::abs(b) ? a : b;
}

}  // namespace crossgait
