// Vectors and poses between Eigen's float64 and PhysX's float32.
#pragma once

#include <PxPhysicsAPI.h>

#include "physics/core/math.h"

namespace crossgait::physx {

namespace px = ::physx;

inline px::PxVec3 vector(const Vector3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}
inline Vector3 vector(const px::PxVec3& v) { return {v.x, v.y, v.z}; }

inline px::PxQuat quaternion(const Quaternion& q) {
  return {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()),
          static_cast<float>(q.w())};
}
/// Converts and makes it unit in float64: what is off 1 is float32's rounding.
inline Quaternion quaternion(const px::PxQuat& q) { return Quaternion(q.w, q.x, q.y, q.z).normalized(); }

inline px::PxTransform transform(const Pose& X) {
  return {vector(Vector3(X.translation())), quaternion(Quaternion(X.linear()))};
}
inline Pose pose(const px::PxTransform& X) { return make_pose(quaternion(X.q), vector(X.p)); }

}  // namespace crossgait::physx
