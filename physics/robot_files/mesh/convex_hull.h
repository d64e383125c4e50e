// Convex hulls of points, and of few of them.
#pragma once

#include <vector>

#include "physics/core/math.h"

namespace crossgait {

struct ConvexHull {
  /// Corners, in the order in which they were taken: the hull of the first n is that of n corners.
  std::vector<Vector3> vertices;
  double volume = 0;  ///< m^3; 0 where all points lie in a plane
  double error = 0;   ///< how far the farthest of the points lies outside, m
};

/// Grows a hull from a tetrahedron, always by the point that lies farthest outside (Barber, Dobkin and
/// Huhdanpaa, The quickhull algorithm for convex hulls, 1996, with one queue for all faces), until none lies
/// outside or there are `most` vertices. The same points give the same hull on every machine; of equally far
/// ones, to 1e-9 of the extent, that with the least x, y and z.
/// @param points  at least one, finite
/// @param most  at least 4
ConvexHull convex_hull(const std::vector<Vector3>& points, int most);

}  // namespace crossgait
