// Linear-algebra names used on every public surface. SI units, radians, double precision.
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace crossgait {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
/// Unit quaternion. Constructed (w, x, y, z), the order of every Crossgait file and interface.
using Quaternion = Eigen::Quaterniond;
/// Rigid transform. X_AB maps coordinates in frame B to frame A: p_AP = X_AB * p_BP.
using Pose = Eigen::Isometry3d;

/// Most joints of one robot. A bound, so that vectors of joint values live inline and a step allocates
/// nothing.
inline constexpr int kMaxJoints = 32;
/// Holds one value per joint, in the order of `RobotDescription::joint_count()`. Inline storage.
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxJoints, 1>;

/// Standard gravity as robots are judged by before there is a world, m/s^2. A world has its own (WorldSpec).
inline constexpr double kGravity = 9.81;

/// What an angle in rad is multiplied by for people to read it.
inline constexpr double kDegreesPerRadian = 180 / M_PI;

/// Returns the matrix of a cross product: cross_matrix(a) b = a x b.
inline Matrix3 cross_matrix(const Vector3& a) {
  Matrix3 m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

inline Pose make_pose(const Quaternion& q, const Vector3& p) {
  Pose X = Pose::Identity();
  X.linear() = q.toRotationMatrix();
  X.translation() = p;
  return X;
}

/// Solves q = Rz(yaw) Ry(pitch) Rx(roll) for roll, pitch, yaw (rad): the Z-Y-X order of URDF and REP-103.
Vector3 roll_pitch_yaw(const Quaternion& q);
/// Returns the same angle in [-pi, pi], rad: std::remainder, which most angles need not be asked of.
inline double wrapped(double angle) noexcept {
  return std::abs(angle) <= M_PI ? angle : std::remainder(angle, 2 * M_PI);
}
/// Inverts `roll_pitch_yaw`.
Quaternion from_roll_pitch_yaw(double roll, double pitch, double yaw);
/// Returns the least rotation that takes z to `axis` (unit); about x where that is -z.
Quaternion rotation_of_z_to(const Vector3& axis);
/// Returns the angle nearest to zero (rad) about the unit vector `axis` that makes the unit vector `v`
/// horizontal, as near as it gets.
double levelling_angle(const Vector3& axis, const Vector3& v);

}  // namespace crossgait
