// Wavefront OBJ files.
#pragma once

#include <string>

#include "physics/robot_files/mesh/mesh_vertices.h"

namespace crossgait {

/// Reads all vertices of an OBJ and its faces, polygons as fans of triangles; none, if there are no faces.
/// @param part  the name of an object (`o`) or a group (`g`), whose faces alone are read; all, if empty
/// @throws ConfigError naming the file and the line, and for a part without faces those that are there
TriangleMesh read_obj(const std::string& path, const std::string& part);

}  // namespace crossgait
