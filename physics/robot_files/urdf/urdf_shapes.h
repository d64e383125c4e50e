// The collision shapes of a URDF's links.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include <urdf_model/link.h>

#include "physics/robot/robot.h"
#include "physics/robot_files/urdf/urdf_warnings.h"

namespace crossgait {

/// Makes shapes of one file's collisions. A mesh becomes what stands for it (mesh_shape.h); where its file is
/// missing, or neither STL nor OBJ, it is dropped and counted.
class UrdfShapes {
 public:
  UrdfShapes(const std::string& urdf_path, UrdfWarnings& warnings) : path_(urdf_path), warnings_(warnings) {}

  /// Appends the shapes of a link, whose frame is at X_BL, to its body. @returns their indices in the body
  /// @throws ConfigError naming the link and collision for impossible sizes, or the mesh file
  std::vector<int> add(const urdf::Link& link, const Pose& X_BL, Body& body);

  /// Vertices of a mesh file in its own frame and units, read once.
  const std::vector<Vector3>& vertices_of(const std::string& file);
  /// Makes a shape that has its name and pose of a mesh's vertices in its frame, m. @param where  for
  /// messages
  void set_vertices(std::vector<Vector3> vertices, const std::string& where, CollisionShape& shape);

  /// Vertices of the meshes behind shapes, in the body's frame (m), by the name of the shape.
  std::map<std::string, std::vector<Vector3>>& mesh_vertices() { return mesh_vertices_; }

 private:
  std::string name_of(const urdf::Collision& collision, const urdf::Link& link, std::size_t index);
  bool set_geometry(const urdf::Geometry& geometry, const urdf::Link& link, CollisionShape& shape);
  bool set_mesh(const urdf::Mesh& mesh, const urdf::Link& link, CollisionShape& shape);

  const std::string& path_;
  UrdfWarnings& warnings_;
  std::set<std::string> names_;
  std::size_t next_name_ = 0;                          ///< for shapes whose own name is taken
  std::map<std::string, std::vector<Vector3>> files_;  ///< vertices by mesh file, in its own frame and units
  std::size_t bytes_ = 0, vertices_ = 0;               ///< of all of them, for their budget
  std::map<std::string, std::vector<Vector3>> mesh_vertices_;
};

}  // namespace crossgait
