#include "physics/robot_files/mesh/stl_reader.h"

#include <cstdint>
#include <cstring>
#include <numeric>
#include <string_view>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "physics/core/text.h"
#include "physics/robot_files/mesh/mesh_corners.h"
#include "physics/robot_files/mesh/mesh_text.h"

namespace crossgait {
namespace {

// A binary STL: a header of 80 bytes, the number of triangles, and for each its normal and three corners as
// floats and two bytes more. Little endian (as every machine that Crossgait builds on).
constexpr std::size_t kStlHeader = 84, kStlTriangle = 50, kStlNormal = 12;

/// "solid NAME facet normal x y z outer loop vertex x y z ...": a name ends with its line, or with "facet".
void read_text_stl(std::string_view text, MeshCorners& corners) {
  bool in_name = false;
  for (std::size_t number = 1; !text.empty(); ++number) {
    std::string_view line = take_line(text);
    for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
      if (equals_ignoring_case(word, "solid") || equals_ignoring_case(word, "endsolid")) in_name = true;
      if (equals_ignoring_case(word, "facet")) in_name = false;
      if (!in_name && equals_ignoring_case(word, "vertex")) corners.read(line, number);
    }
    in_name = false;
  }
}

void read_binary_stl(std::string_view bytes, std::size_t triangles, MeshCorners& corners) {
  for (std::size_t i = 0; i < triangles; ++i) {
    const char* at = bytes.data() + kStlHeader + i * kStlTriangle + kStlNormal;
    for (int corner = 0; corner < 3; ++corner, at += 3 * sizeof(float)) {
      float xyz[3];
      std::memcpy(xyz, at, sizeof xyz);
      corners.add({xyz[0], xyz[1], xyz[2]}, 0);
    }
  }
}

}  // namespace

TriangleMesh read_stl(const std::string& path) {
  const std::string bytes = read_text_file(path, kMeshBudget);
  MeshCorners corners(path);
  std::uint32_t triangles = 0;
  if (bytes.size() >= kStlHeader) std::memcpy(&triangles, bytes.data() + kStlHeader - 4, 4);
  // Letters for the number of triangles would be more than a hundred million.
  const bool is_binary =
      bytes.size() >= kStlHeader && bytes.size() >= kStlHeader + kStlTriangle * std::size_t{triangles};
  std::string_view first_word = bytes;
  if (is_binary) {
    read_binary_stl(bytes, triangles, corners);
  } else if (equals_ignoring_case(take_word(first_word), "solid")) {
    read_text_stl(bytes, corners);
  } else {
    corners.fail(0, "a whole STL mesh", size_in_words(bytes.size()));
  }
  TriangleMesh mesh;
  mesh.vertices = corners.take();
  mesh.triangles.resize(mesh.vertices.size());
  std::iota(mesh.triangles.begin(), mesh.triangles.end(), 0U);
  return mesh;
}

}  // namespace crossgait
