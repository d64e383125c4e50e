// The collision shapes of a URDF's links.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include <urdf_model/link.h>

#include "physics/robot/robot.h"
#include "physics/robot_files/mesh/robot_meshes.h"
#include "physics/robot_files/reader_warnings.h"

namespace crossgait {

/// Makes shapes of one file's collisions. A mesh becomes what stands for it (mesh_shape.h); where its file is
/// missing, or no STL, OBJ or DAE, it is dropped and counted.
class UrdfShapes {
 public:
  UrdfShapes(const std::string& urdf_path, ReaderWarnings& warnings)
      : path_(urdf_path), warnings_(warnings), meshes_(urdf_path, warnings) {}

  /// Appends the shapes of a link, whose frame is at X_BL, to its body. @returns their indices in the body
  /// @throws ConfigError naming the link and collision for impossible sizes, or the mesh file
  std::vector<int> add(const urdf::Link& link, const Pose& X_BL, Body& body);

  /// Does what RobotMeshes::mesh_vertices does.
  std::map<std::string, std::vector<Vector3>>& mesh_vertices() { return meshes_.mesh_vertices(); }

 private:
  std::string name_of(const urdf::Collision& collision, const urdf::Link& link, std::size_t index);
  bool set_geometry(const urdf::Geometry& geometry, const urdf::Link& link, CollisionShape& shape);
  bool set_mesh(const urdf::Mesh& mesh, const urdf::Link& link, CollisionShape& shape);

  const std::string& path_;
  ReaderWarnings& warnings_;
  RobotMeshes meshes_;
  std::set<std::string> names_;
  std::size_t next_name_ = 0;  ///< for shapes whose own name is taken
};

}  // namespace crossgait
