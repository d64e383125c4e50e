// STL files.
#pragma once

#include <string>

#include "physics/robot_files/mesh/mesh_vertices.h"

namespace crossgait {

/// Reads a binary STL or one of text, three vertices a triangle as the file has them: equal ones are not
/// welded. It is binary if it is as long as the triangles that it counts take, or longer, whatever it begins
/// with; else text, if it begins with "solid". Its keywords may be in capitals, and on one line.
/// @throws ConfigError naming the file and, in texts, the line
TriangleMesh read_stl(const std::string& path);

}  // namespace crossgait
