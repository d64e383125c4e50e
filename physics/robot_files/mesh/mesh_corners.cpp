#include "physics/robot_files/mesh/mesh_corners.h"

#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "physics/core/text.h"
#include "physics/robot_files/mesh/mesh_text.h"

namespace crossgait {

void MeshCorners::add(const Vector3& vertex, std::size_t line) {
  if (!vertex.allFinite()) fail(line, "finite coordinates", "others");
  if (vertices_.size() == kMeshBudget.values)
    fail(line, fmt::format("at most {} vertices", kMeshBudget.values), "more");
  vertices_.push_back(vertex);
}

void MeshCorners::read(std::string_view& text, std::size_t line) {
  Vector3 vertex;
  for (double& coordinate : vertex) {
    const std::string_view word = take_word(text);
    const auto value = parse_number(word);
    if (!value) fail(line, "three finite coordinates", fmt::format("'{}'", printable_text(word, 200)));
    coordinate = *value;
  }
  add(vertex, line);
}

std::vector<Vector3> MeshCorners::take() {
  if (vertices_.empty()) fail(0, "a mesh with vertices", "none");
  return std::move(vertices_);
}

void MeshCorners::fail(std::size_t line, std::string_view expected, std::string_view found) const {
  throw ConfigError(path_, line == 0 ? "file" : fmt::format("line {}", line), expected, found);
}

void MeshPartNames::add(std::string_view name) {
  constexpr std::size_t kMost = 500;  // bytes, of a message
  if (name.empty() || text_.size() > kMost) return;
  const std::string quoted = fmt::format("'{}'", printable_text(name, 100));
  if (text_.find(quoted) != std::string::npos) return;
  text_ += (text_.empty() ? "" : ", ") + quoted;
}

void MeshPartNames::fail_without(const std::string& path, const std::string& part) const {
  throw ConfigError(path, "file", fmt::format("faces of a part named '{}'", printable_text(part, 200)),
                    text_.empty() ? "no part with a name" : text_);
}

}  // namespace crossgait
