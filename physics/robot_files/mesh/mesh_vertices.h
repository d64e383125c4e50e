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

/// Tells whether a mesh has volume at this scale: no number is 0; negative ones mirror it.
inline bool is_mesh_scale(const Vector3& scale) { return scale.cwiseAbs().minCoeff() > 0; }
inline constexpr std::string_view kMeshScale = "a scale of three numbers that are not 0";

/// Tells whether `read_mesh_vertices` reads files of this name: *.stl, *.obj and *.dae, in capitals, too.
bool is_mesh_format(const std::string& path);

/// Reads the different vertices of the faces of an STL (binary or text) or an OBJ file, in its own units and
/// frame, or of a COLLADA file as `read_dae` has it, sorted by x, y and z; at least one. Vertices that no
/// face has do not count, unless an OBJ has no face at all: then they all do. Normals and materials are
/// passed over.
/// @param part  the name of what alone is read: an object or a group of an OBJ, a node or a geometry of a
/// COLLADA file; all, if empty
/// @throws ConfigError naming the file and, in texts, the line: unreadable, beyond kMeshBudget, no such mesh
/// or
///   part, faces of corners that are not there, or coordinates that are no finite numbers
std::vector<Vector3> read_mesh_vertices(const std::string& path, const std::string& part = {});

/// Holds a surface: its corners, and triangles as indices of three corners each.
struct TriangleMesh {
  std::vector<Vector3> vertices;
  std::vector<std::uint32_t> triangles;
};

/// Reads what such a file looks like; polygons come as fans of triangles. At least one triangle.
/// @throws ConfigError as above
TriangleMesh read_mesh_triangles(const std::string& path);

}  // namespace crossgait
