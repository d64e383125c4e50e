// urdfdom's vectors and poses as ours.
#pragma once

#include <urdf_model/pose.h>

#include "physics/core/math.h"

namespace crossgait {

inline Vector3 to_vector(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

inline Pose to_pose(const urdf::Pose& pose) {
  const urdf::Rotation& r = pose.rotation;
  return make_pose(Quaternion(r.w, r.x, r.y, r.z).normalized(), to_vector(pose.position));
}

}  // namespace crossgait
