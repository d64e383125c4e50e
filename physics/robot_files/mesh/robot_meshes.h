// The collision meshes of one robot.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "physics/robot/robot.h"
#include "physics/robot_files/reader_warnings.h"

namespace crossgait {

/// Reads mesh files, each once and all within their budget, and makes shapes of them (mesh_shape.h), one fit
/// for all uses of the same vertices.
class RobotMeshes {
 public:
  /// @param path  of the robot's file, for messages
  RobotMeshes(const std::string& path, ReaderWarnings& warnings) : path_(path), warnings_(warnings) {}

  /// Returns vertices of a mesh file, or of a part of it (`read_mesh_vertices`), in its own frame and units,
  /// read once.
  const std::vector<Vector3>& vertices_of(const std::string& file, const std::string& part = {});
  /// Makes a shape that has its name and pose of a mesh's vertices in its frame, m. @param where  for
  /// messages
  void set_vertices(std::vector<Vector3> vertices, const std::string& where, CollisionShape& shape);

  /// Returns vertices of the meshes behind shapes, in the body's frame (m), by the name of the shape.
  std::map<std::string, std::vector<Vector3>>& mesh_vertices() { return mesh_vertices_; }

 private:
  /// Returns the shape that stands for vertices, in their frame.
  const CollisionShape& fitted_to(const std::vector<Vector3>& vertices, const std::string& where);

  const std::string& path_;
  ReaderWarnings& warnings_;
  /// Vertices by mesh file and part, in its own frame and units.
  std::map<std::pair<std::string, std::string>, std::vector<Vector3>> files_;
  std::size_t bytes_ = 0, vertices_ = 0;          ///< of all of them, for their budget
  std::map<std::string, CollisionShape> fitted_;  ///< by the SHA-256 of the vertices
  std::map<std::string, std::vector<Vector3>> mesh_vertices_;
};

}  // namespace crossgait
