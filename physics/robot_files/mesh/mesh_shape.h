// The simple shape that collides in the place of a mesh.
#pragma once

#include <vector>

#include "physics/robot/robot.h"

namespace crossgait {

/// Sets type, size, vertices and pose of `shape`, whose X_BG is the mesh's frame, to what stands for the
/// mesh:
///  - the box around it, along the axes of the mesh's frame, at least 0.2 mm thick; or
///  - where it has less volume than the box, the least capsule around it whose axis passes through the box's
///    centre along its longest edge;
///  - where the smaller of the two exceeds the volume of the mesh's convex hull by more than a quarter, that
///    hull, of the first `kMaxHullVertices` vertices that `convex_hull` takes: the corners that stand out
///    most.
/// Flat meshes are boxes. The same vertices in the same order give the same shape.
/// @param vertices  in the mesh's frame, m; at least one
void fit_mesh(const std::vector<Vector3>& vertices, CollisionShape& shape);

}  // namespace crossgait
