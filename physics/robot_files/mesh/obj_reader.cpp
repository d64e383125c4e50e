#include "physics/robot_files/mesh/obj_reader.h"

#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "physics/core/text.h"
#include "physics/robot_files/mesh/mesh_corners.h"
#include "physics/robot_files/mesh/mesh_text.h"
#include "physics/robot_files/xml_text.h"

namespace crossgait {
namespace {

std::vector<Vector3> read_vertices(std::string_view text, const std::string& path) {
  MeshCorners corners(path);
  for (std::size_t number = 1; !text.empty(); ++number) {
    std::string_view line = take_line(text);
    if (take_word(line) == "v") corners.read(line, number);
  }
  return corners.take();
}

class ObjFaces {
 public:
  ObjFaces(const std::string& path, const std::string& part, TriangleMesh& mesh)
      : path_(path), part_(part), mesh_(mesh), takes_(part.empty()) {}

  void read(std::string_view text) {
    std::ptrdiff_t vertices = 0;  // up to this line
    for (std::size_t number = 1; !text.empty(); ++number) {
      std::string_view line = take_line(text);
      const std::string_view keyword = take_word(line);
      if (keyword == "v") ++vertices;
      if (keyword == "o" || keyword == "g") begin_part(keyword == "o", line);
      if (keyword == "f" && (takes_ || in_object_)) read_face(line, number, vertices);
    }
    if (mesh_.triangles.empty() && !part_.empty()) names_.fail_without(path_, part_);
  }

 private:
  /// An object has one name, of blanks too; a face may be of several groups. A new object ends the groups.
  void begin_part(bool is_object, std::string_view line) {
    if (part_.empty()) return;
    const std::string whole = trimmed(line);
    names_.add(whole);
    bool is_named = whole == part_;
    if (is_object) {
      in_object_ = is_named;
      takes_ = false;
      return;
    }
    for (std::string_view word = take_word(line); !word.empty(); word = take_word(line))
      is_named = is_named || word == part_;
    takes_ = is_named;
  }

  /// "f a b c ...", where each is a vertex's number from 1, or from the end if negative, and what follows a
  /// slash is of no interest.
  void read_face(std::string_view line, std::size_t number, std::ptrdiff_t vertices) {
    const auto all = static_cast<double>(mesh_.vertices.size());
    std::vector<std::uint32_t> corners;
    for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
      const auto value = parse_number(word.substr(0, word.find('/')));
      const double index = value ? (*value < 0 ? static_cast<double>(vertices) + *value : *value - 1) : -1;
      if (!(index >= 0 && index < all) || index != std::floor(index)) {
        throw ConfigError(path_, fmt::format("line {}", number),
                          fmt::format("numbers of the {} vertices", mesh_.vertices.size()),
                          fmt::format("'{}'", printable_text(word, 200)));
      }
      corners.push_back(static_cast<std::uint32_t>(index));
    }
    for (std::size_t i = 2; i < corners.size(); ++i) {
      if (mesh_.triangles.size() >= 3 * kMeshBudget.values)
        throw ConfigError(path_, "file", fmt::format("at most {} triangles", kMeshBudget.values), "more");
      mesh_.triangles.insert(mesh_.triangles.end(), {corners[0], corners[i - 1], corners[i]});
    }
  }

  const std::string &path_, &part_;
  TriangleMesh& mesh_;
  MeshPartNames names_;
  bool takes_, in_object_ = false;
};

}  // namespace

TriangleMesh read_obj(const std::string& path, const std::string& part) {
  const std::string text = read_text_file(path, kMeshBudget);
  TriangleMesh mesh;
  mesh.vertices = read_vertices(text, path);
  ObjFaces(path, part, mesh).read(text);
  return mesh;
}

}  // namespace crossgait
