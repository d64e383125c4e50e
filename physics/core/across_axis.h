// What an axis leaves of a vector.
#pragma once

#include "physics/core/math.h"

namespace crossgait {

/// Returns the part of `v` at a right angle to the unit vector `axis`.
inline Vector3 across(const Vector3& v, const Vector3& axis) { return v - v.dot(axis) * axis; }

}  // namespace crossgait
