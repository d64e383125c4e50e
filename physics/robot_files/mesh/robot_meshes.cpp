#include "physics/robot_files/mesh/robot_meshes.h"

#include <filesystem>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "physics/core/sha256.h"
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
  const CollisionShape& fitted = fitted_to(vertices, where);
  shape.type = fitted.type;
  shape.size = fitted.size;
  shape.vertices = fitted.vertices;
  shape.X_BG = X_BM * fitted.X_BG;
  for (Vector3& vertex : vertices) vertex = X_BM * vertex;
  mesh_vertices_.emplace(shape.name, std::move(vertices));
  warnings_.count("took ", stand_in(shape.type), where);
}

const CollisionShape& RobotMeshes::fitted_to(const std::vector<Vector3>& vertices, const std::string& where) {
  static_assert(sizeof(Vector3) == 3 * sizeof(double));
  const auto* bytes = reinterpret_cast<const char*>(vertices.data());
  const auto [place, is_new] = fitted_.try_emplace(sha256_hex({bytes, vertices.size() * sizeof(Vector3)}));
  if (is_new) {
    if (fitted_.size() > kMaxFittedMeshes) {
      throw ConfigError(path_, where,
                        fmt::format("at most {} collision meshes that differ", kMaxFittedMeshes), "more");
    }
    fit_mesh(vertices, place->second);
  }
  return place->second;
}

const std::vector<Vector3>& RobotMeshes::vertices_of(const std::string& file, const std::string& part) {
  const auto known = files_.find({file, part});
  if (known != files_.end()) return known->second;
  std::error_code error;
  bytes_ += std::filesystem::file_size(file, error);
  if (error || bytes_ > kMaxRobotMeshBytes) {
    throw ConfigError(path_, "collision meshes",
                      fmt::format("files of at most {} together", size_in_words(kMaxRobotMeshBytes)), "more");
  }
  return files_.emplace(std::pair(file, part), read_mesh_vertices(file, part)).first->second;
}

}  // namespace crossgait
