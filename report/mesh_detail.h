// Meshes as coarse as a picture shows them.
#pragma once

#include "physics/robot_files/mesh/mesh_vertices.h"

namespace crossgait {

/// Triangles that a mesh may have before it is made coarser.
inline constexpr std::size_t kFineTriangles = 2000;

/// Merges the vertices of every cube of a grid into their mean, and leaves out triangles that lose their area
/// and those that are there twice (vertex clustering: Rossignac and Borrel, Multi-resolution 3D
/// approximations for rendering complex scenes, 1993). No vertex moves by more than the diagonal of a cube.
/// @param cell  edge of the cubes, in the units of the mesh, positive
TriangleMesh coarser(const TriangleMesh& mesh, double cell);

}  // namespace crossgait
