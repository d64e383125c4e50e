#include "physics/robot_files/mesh/robot_meshes.h"

#include <filesystem>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "physics/robot_files/mesh/mesh_shape.h"
#include "physics/robot_files/mesh/mesh_vertices.h"

namespace crossgait {
namespace {

std::string_view stand_in(ShapeType type) {
  switch (type) {
    case ShapeType::kCapsule:
      return " collision mesh(es) for the capsule around them";
    case ShapeType::kHull:
      return " collision mesh(es) for their convex hull";
    default:
      return " collision mesh(es) for the box around them";
  }
}

}  // namespace

void RobotMeshes::set_vertices(std::vector<Vector3> vertices, const std::string& where,
                               CollisionShape& shape) {
  vertices_ += vertices.size();
  if (vertices_ > kMaxRobotMeshVertices) {
    throw ConfigError(path_, where,
                      fmt::format("at most {} vertices of collision meshes", kMaxRobotMeshVertices), "more");
  }
  const Pose X_BM = shape.X_BG;
  fit_mesh(vertices, shape);
  for (Vector3& vertex : vertices) vertex = X_BM * vertex;
  mesh_vertices_.emplace(shape.name, std::move(vertices));
  warnings_.count("took ", stand_in(shape.type), where);
}

const std::vector<Vector3>& RobotMeshes::vertices_of(const std::string& file) {
  const auto known = files_.find(file);
  if (known != files_.end()) return known->second;
  std::error_code error;
  bytes_ += std::filesystem::file_size(file, error);
  if (error || bytes_ > kMaxRobotMeshBytes) {
    throw ConfigError(path_, "collision meshes",
                      fmt::format("files of at most {} together", size_in_words(kMaxRobotMeshBytes)), "more");
  }
  return files_.emplace(file, read_mesh_vertices(file)).first->second;
}

}  // namespace crossgait
