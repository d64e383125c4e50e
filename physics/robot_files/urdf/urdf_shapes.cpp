#include "physics/robot_files/urdf/urdf_shapes.h"

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/robot/robot_check.h"
#include "physics/robot_files/mesh/mesh_path.h"
#include "physics/robot_files/mesh/mesh_vertices.h"
#include "physics/robot_files/urdf/urdf_elements.h"
#include "physics/robot_files/urdf/urdf_pose.h"

namespace crossgait {
std::vector<int> UrdfShapes::add(const urdf::Link& link, const Pose& X_BL, Body& body) {
  std::vector<int> indices;
  for (const urdf::CollisionSharedPtr& collision : link.collision_array) {
    CollisionShape shape;
    shape.name = name_of(*collision, link, indices.size());
    shape.X_BG = X_BL * to_pose(collision->origin);
    if (!set_geometry(*collision->geometry, link, shape)) continue;
    check_shape(shape, path_, fmt::format("link '{}', collision '{}'", link.name, shape.name));
    indices.push_back(static_cast<int>(body.shapes.size()));
    body.shapes.push_back(std::move(shape));
  }
  return indices;
}

std::string UrdfShapes::name_of(const urdf::Collision& collision, const urdf::Link& link, std::size_t index) {
  if (!collision.name.empty()) {
    if (names_.insert(collision.name).second) return collision.name;
    warnings_.count("renamed ", " collision shape(s) whose name was taken",
                    fmt::format("link '{}'", link.name));
  }
  std::string name = fmt::format("{}_collision_{}", link.name, index);
  while (!names_.insert(name).second) name = fmt::format("{}_collision_{}", link.name, next_name_++);
  return name;
}

bool UrdfShapes::set_geometry(const urdf::Geometry& geometry, const urdf::Link& link, CollisionShape& shape) {
  switch (geometry.type) {
    case urdf::Geometry::SPHERE:
      shape.type = ShapeType::kSphere;
      shape.size = {static_cast<const urdf::Sphere&>(geometry).radius, 0, 0};
      return true;
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
      shape.type = ShapeType::kCylinder;
      shape.size = {cylinder.radius, cylinder.length / 2, 0};
      return true;
    }
    case urdf::Geometry::MESH: {
      const auto& mesh = static_cast<const urdf::Mesh&>(geometry);
      if (mesh.filename != kCapsuleMesh) return set_mesh(mesh, link, shape);
      shape.type = ShapeType::kCapsule;
      shape.size = {mesh.scale.x, mesh.scale.y / 2, 0};
      return true;
    }
    case urdf::Geometry::BOX:
      break;
  }
  shape.type = ShapeType::kBox;
  shape.size = to_vector(static_cast<const urdf::Box&>(geometry).dim) / 2;
  return true;
}

bool UrdfShapes::set_mesh(const urdf::Mesh& mesh, const urdf::Link& link, CollisionShape& shape) {
  const std::string where = fmt::format("link '{}' ('{}')", link.name, printable_text(mesh.filename, 200));
  if (!is_mesh_format(mesh.filename)) {
    warnings_.count("dropped ", fmt::format(" collision mesh(es) that are no {}", kMeshFormats), where);
    return false;
  }
  const Vector3 scale = to_vector(mesh.scale);
  if (!is_mesh_scale(scale))
    throw ConfigError(path_, where, kMeshScale, fmt::format("'{} {} {}'", scale.x(), scale.y(), scale.z()));
  const auto file = find_named_file(mesh.filename, path_);
  if (!file) {
    warnings_.count("dropped ", " collision mesh(es) whose file is not there", where);
    return false;
  }
  std::vector<Vector3> vertices = meshes_.vertices_of(*file);
  for (Vector3& vertex : vertices) vertex = vertex.cwiseProduct(scale);
  meshes_.set_vertices(std::move(vertices), where, shape);
  return true;
}

}  // namespace crossgait
