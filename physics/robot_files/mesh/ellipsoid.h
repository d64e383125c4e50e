// Vertices that stand for an ellipsoid, which no engine here has.
#pragma once

#include <vector>

#include "physics/core/math.h"

namespace crossgait {

/// Returns points on an ellipsoid about the axes of its frame, whose hull is within 2 % of its radii.
/// @param radii  m
std::vector<Vector3> ellipsoid_vertices(const Vector3& radii);

}  // namespace crossgait
