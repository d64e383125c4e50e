// Between Bullet's and Eigen's vectors.
#pragma once

#include <LinearMath/btMatrix3x3.h>
#include <LinearMath/btQuaternion.h>
#include <LinearMath/btTransform.h>
#include <LinearMath/btVector3.h>

#include "physics/core/math.h"

namespace crossgait::bullet {

inline Vector3 vector(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
inline btVector3 vector(const Vector3& v) { return {v.x(), v.y(), v.z()}; }
inline Quaternion quaternion(const btQuaternion& q) { return {q.w(), q.x(), q.y(), q.z()}; }
inline btQuaternion quaternion(const Quaternion& q) { return {q.x(), q.y(), q.z(), q.w()}; }
inline Matrix3 matrix(const btMatrix3x3& m) {
  Matrix3 R;
  R << m[0].x(), m[0].y(), m[0].z(), m[1].x(), m[1].y(), m[1].z(), m[2].x(), m[2].y(), m[2].z();
  return R;
}
inline btTransform transform(const Pose& X) {
  return btTransform(quaternion(Quaternion(X.linear())), vector(Vector3(X.translation())));
}

}  // namespace crossgait::bullet
