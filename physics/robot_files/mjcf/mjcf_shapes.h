// The collision and visual shapes of an MJCF's geoms.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "physics/robot_files/mesh/robot_meshes.h"
#include "physics/robot_files/mjcf/mjcf_model.h"
#include "physics/robot_files/mjcf/mjcf_parts.h"

namespace crossgait {

/// Makes shapes of one file's geoms, as MuJoCo's viewer and its collisions have it: what collides with
/// anything (contype, conaffinity) is a collision shape; what stands in groups 0 to 2 is seen.
class MjcfShapes {
 public:
  MjcfShapes(const std::string& path, const MjcfParts& parts, ReaderWarnings& warnings)
      : path_(path), parts_(parts), warnings_(warnings), meshes_(path, warnings) {}

  /// Appends what a geom is to its body. @param X_BA  pose of the geom's own body in that body
  /// @returns indices of its collision shapes @throws ConfigError naming the geom, or the mesh file
  std::vector<int> add(const MjcfGeom& geom, const Pose& X_BA, Body& body);

  /// Does what RobotMeshes::mesh_vertices does.
  std::map<std::string, std::vector<Vector3>>& mesh_vertices() { return meshes_.mesh_vertices(); }

 private:
  void collide(const MjcfGeom& geom, const Pose& X_BG, Body& body);
  void show(const MjcfGeom& geom, const Pose& X_BG, Body& body);
  /// Sets what stands for a mesh or an ellipsoid. @returns false of a mesh that is dropped
  bool set_vertices(const MjcfGeom& geom, CollisionShape& shape);
  void set_visual_mesh(const MjcfGeom& geom, VisualShape& visual);
  void add_shape(const std::string& name, ShapeType type, const Vector3& size, const Pose& X_BG, Body& body);
  std::string where(const MjcfGeom& geom) const;

  const std::string& path_;
  const MjcfParts& parts_;
  ReaderWarnings& warnings_;
  RobotMeshes meshes_;
};

}  // namespace crossgait
