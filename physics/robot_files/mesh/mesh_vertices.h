// The vertices and triangles of a mesh file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "physics/core/math.h"

namespace crossgait {

/// The formats of meshes that are read, for people.
inline constexpr std::string_view kMeshFormats = "STL, OBJ or DAE";

/// Tells whether `read_mesh_vertices` reads files of this name: *.stl, *.obj and *.dae, in capitals, too.
bool is_mesh_format(const std::string& path);

/// Reads the different vertices of an STL (binary or text) or an OBJ file, in its own units and frame, or of
/// a COLLADA file as `read_dae` has it, sorted by x, y and z; at least one. Faces, normals and materials are
/// passed over.
/// @throws ConfigError naming the file and, in texts, the line: unreadable, beyond kMeshBudget, no such mesh,
/// or
///   coordinates that are no finite numbers
std::vector<Vector3> read_mesh_vertices(const std::string& path);

/// Holds a surface: its corners, and triangles as indices of three corners each.
struct TriangleMesh {
  std::vector<Vector3> vertices;
  std::vector<std::uint32_t> triangles;
};

/// Reads what such a file looks like; polygons come as fans of triangles. At least one triangle.
/// @throws ConfigError as above, and for faces of corners that are not there
TriangleMesh read_mesh_triangles(const std::string& path);

}  // namespace crossgait
