// COLLADA files (.dae) as triangles.
#pragma once

#include <string>

#include "physics/robot_files/mesh/mesh_vertices.h"

namespace crossgait {

/// Reads the surface of a COLLADA 1.4 or 1.5 file in metres: what its scene shows, each geometry as often and
/// wherever nodes put it, or all geometries if there is no scene. Polygons come as fans of triangles, lines
/// are passed over, vertices that are equal are one. `<unit meter>` is the scale. The axes are the file's,
/// whatever
/// `<up_axis>` says, as RViz, MoveIt and Gazebo have them, which robots' files are made for.
/// @param part  the name or id of a node, with all that is in it, or, where no node has it, of a geometry:
/// nothing else is read; all, if empty
/// @throws ConfigError naming the file and the line: unreadable, beyond kMeshBudget and kDaeBudget, indices
/// of vertices that are not there, nodes inside themselves, skins, no such part, and no triangle
TriangleMesh read_dae(const std::string& path, const std::string& part = {});

}  // namespace crossgait
