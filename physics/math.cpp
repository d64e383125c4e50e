#include "crossgait/physics/math.h"

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

}  // namespace crossgait
