#include "physics/robot_files/mesh/mesh_vertices.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <string_view>
#include <tuple>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "physics/core/text.h"
#include "physics/robot_files/mesh/dae_reader.h"

namespace crossgait {
namespace {

// A binary STL: a header of 80 bytes, the number of triangles, and for each its normal and three corners as
// floats and two bytes more. Little endian (as every machine that Crossgait builds on).
constexpr std::size_t kStlHeader = 84, kStlTriangle = 50, kStlNormal = 12;

std::string lower_extension(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  std::string extension = dot == std::string::npos ? "" : path.substr(dot);
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return extension;
}

/// Vertices of one file, counted.
class MeshVertices {
 public:
  explicit MeshVertices(const std::string& path) : path_(path) {}

  /// @param line  of a text; 0 in others
  void add(const Vector3& vertex, std::size_t line) {
    if (!vertex.allFinite()) fail(line, "finite coordinates", "others");
    if (vertices_.size() == kMeshBudget.values) {
      fail(line, fmt::format("at most {} vertices", kMeshBudget.values), "more");
    }
    vertices_.push_back(vertex);
  }

  [[noreturn]] void fail(std::size_t line, std::string_view expected, std::string_view found) const {
    throw ConfigError(path_, line == 0 ? "file" : fmt::format("line {}", line), expected, found);
  }

  /// In the order of the file.
  std::vector<Vector3> all() {
    if (vertices_.empty()) fail(0, "a mesh with vertices", "none");
    return std::move(vertices_);
  }

  std::vector<Vector3> sorted() {
    if (vertices_.empty()) fail(0, "a mesh with vertices", "none");
    const auto key = [](const Vector3& v) { return std::tuple(v.x(), v.y(), v.z()); };
    std::sort(vertices_.begin(), vertices_.end(),
              [&](const Vector3& a, const Vector3& b) { return key(a) < key(b); });
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
    vertices_.shrink_to_fit();
    return std::move(vertices_);
  }

 private:
  const std::string& path_;
  std::vector<Vector3> vertices_;
};

/// Takes the first word off a line.
std::string_view next_word(std::string_view& line) {
  constexpr std::string_view kSpace = " \t\r\v\f";
  line.remove_prefix(std::min(line.find_first_not_of(kSpace), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kSpace));
  line.remove_prefix(word.size());
  return word;
}

/// Lines "<keyword> x y z": those of an STL's text and of an OBJ look alike.
void read_lines(std::string_view text, std::string_view keyword, MeshVertices& vertices) {
  for (std::size_t number = 1; !text.empty(); ++number) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (next_word(line) != keyword) continue;
    Vector3 vertex;
    for (double& coordinate : vertex) {
      const std::string_view word = next_word(line);
      const auto value = parse_number(word);
      if (!value) vertices.fail(number, "three finite coordinates", fmt::format("'{}'", word));
      coordinate = *value;
    }
    vertices.add(vertex, number);
  }
}

void read_binary_stl(std::string_view bytes, std::size_t triangles, MeshVertices& vertices) {
  for (std::size_t i = 0; i < triangles; ++i) {
    const char* at = bytes.data() + kStlHeader + i * kStlTriangle + kStlNormal;
    for (int corner = 0; corner < 3; ++corner, at += 3 * sizeof(float)) {
      float xyz[3];
      std::memcpy(xyz, at, sizeof xyz);
      vertices.add({xyz[0], xyz[1], xyz[2]}, 0);
    }
  }
}

void read_stl(const std::string& text, MeshVertices& vertices) {
  std::uint32_t triangles = 0;
  if (text.size() >= kStlHeader) std::memcpy(&triangles, text.data() + kStlHeader - 4, 4);
  const std::size_t size = kStlHeader + kStlTriangle * triangles;
  const bool is_text = text.starts_with("solid") && text.size() != size;  // binary ones may begin so, too
  if (is_text) {
    read_lines(text, "vertex", vertices);
  } else if (text.size() >= kStlHeader && text.size() >= size) {
    read_binary_stl(text, triangles, vertices);
  } else {
    vertices.fail(0, "a whole STL mesh", size_in_words(text.size()));
  }
}

/// Equal corners become one.
TriangleMesh weld(const std::vector<Vector3>& corners) {
  TriangleMesh mesh;
  std::map<std::tuple<double, double, double>, std::uint32_t> known;
  for (const Vector3& v : corners) {
    const auto [it, is_new] =
        known.try_emplace({v.x(), v.y(), v.z()}, static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new) mesh.vertices.push_back(v);
    mesh.triangles.push_back(it->second);
  }
  return mesh;
}

/// Lines "f a b c ...", where each is a vertex's number from 1, or from the end if negative, and what follows
/// a slash is of no interest.
void read_faces(std::string_view text, const std::string& path, TriangleMesh& mesh) {
  std::ptrdiff_t vertices = 0;  // up to this line
  for (std::size_t number = 1; !text.empty(); ++number) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    const std::string_view keyword = next_word(line);
    if (keyword == "v") ++vertices;
    if (keyword != "f") continue;
    std::vector<std::uint32_t> corners;
    for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
      const auto value = parse_number(word.substr(0, word.find('/')));
      const double index = value ? (*value < 0 ? static_cast<double>(vertices) + *value : *value - 1) : -1;
      if (!(index >= 0 && index < static_cast<double>(mesh.vertices.size())) || index != std::floor(index)) {
        throw ConfigError(path, fmt::format("line {}", number),
                          fmt::format("numbers of the {} vertices", mesh.vertices.size()),
                          fmt::format("'{}'", word));
      }
      corners.push_back(static_cast<std::uint32_t>(index));
    }
    for (std::size_t i = 2; i < corners.size(); ++i) {
      if (mesh.triangles.size() >= 3 * kMeshBudget.values)
        throw ConfigError(path, "file", fmt::format("at most {} triangles", kMeshBudget.values), "more");
      mesh.triangles.insert(mesh.triangles.end(), {corners[0], corners[i - 1], corners[i]});
    }
  }
}

}  // namespace

bool is_mesh_format(const std::string& path) {
  const std::string extension = lower_extension(path);
  return extension == ".stl" || extension == ".obj" || extension == ".dae";
}

std::vector<Vector3> read_mesh_vertices(const std::string& path) {
  if (lower_extension(path) == ".dae") {
    MeshVertices vertices(path);
    for (const Vector3& vertex : read_dae(path).vertices) vertices.add(vertex, 0);
    return vertices.sorted();
  }
  const std::string text = read_text_file(path, kMeshBudget);
  MeshVertices vertices(path);
  if (lower_extension(path) == ".stl") {
    read_stl(text, vertices);
  } else {
    read_lines(text, "v", vertices);
  }
  return vertices.sorted();
}

TriangleMesh read_mesh_triangles(const std::string& path) {
  if (lower_extension(path) == ".dae") return read_dae(path);
  const std::string text = read_text_file(path, kMeshBudget);
  MeshVertices vertices(path);
  TriangleMesh mesh;
  if (lower_extension(path) == ".stl") {
    read_stl(text, vertices);
    mesh = weld(vertices.all());
  } else {
    read_lines(text, "v", vertices);
    mesh.vertices = vertices.all();
    read_faces(text, path, mesh);
  }
  if (mesh.triangles.empty() || mesh.triangles.size() % 3 != 0)
    throw ConfigError(path, "file", "whole triangles", fmt::format("{} corners", mesh.triangles.size()));
  return mesh;
}

}  // namespace crossgait
