// Collision and visual shapes of an SDF's links.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "physics/robot/robot.h"
#include "physics/robot_files/contact_of_file.h"
#include "physics/robot_files/mesh/robot_meshes.h"
#include "physics/robot_files/reader_warnings.h"
#include "physics/robot_files/sdf/sdf_document.h"

namespace crossgait {

/// Makes shapes of one file's links. A shape that is another's namesake, on another link, gets its link's
/// name before its own. What is no box, sphere, cylinder, capsule, ellipsoid or mesh, and a mesh of another
/// format or whose file is not there, is dropped and counted.
class SdfShapes {
 public:
  SdfShapes(const std::string& path, ReaderWarnings& warnings)
      : path_(path), warnings_(warnings), meshes_(path, warnings) {}

  /// Appends what collides of a link, whose frame is at X_BL, to its body. An ellipsoid becomes what stands
  /// for a mesh (mesh_shape.h). @returns the indices in the body
  /// @throws ConfigError naming the element for impossible sizes, or the mesh file
  std::vector<int> add(const SdfElement& link, const std::string& name, const Pose& X_BL, Body& body);

  /// Appends what a link looks like. Looks make no file unfit: a visual without a shape, or with numbers that
  /// are none, is dropped and counted. Colours are `diffuse`, else `ambient`; textures, scripts and lights
  /// are passed over without a word.
  void add_visuals(const SdfElement& link, const Pose& X_BL, Body& body);

  /// Does what RobotMeshes::mesh_vertices does.
  std::map<std::string, std::vector<Vector3>>& mesh_vertices() { return meshes_.mesh_vertices(); }
  /// Returns contact settings of the shapes that say any, by their names.
  std::map<std::string, ContactNumbers>& contacts() { return contacts_; }

 private:
  std::string name_of(const SdfElement& collision, const std::string& link);
  bool set_geometry(const SdfElement& shape, CollisionShape& collision);
  bool set_mesh(const SdfElement& mesh, CollisionShape& collision);
  void show(const SdfElement& visual, const Pose& X_BL, Body& body);
  void show_mesh(const SdfElement& mesh, VisualShape& visual);
  std::string where(const SdfElement& element) const { return sdf_place(element, path_); }

  const std::string& path_;
  ReaderWarnings& warnings_;
  RobotMeshes meshes_;
  std::set<std::string> names_;
  std::map<std::string, ContactNumbers> contacts_;
  std::size_t next_name_ = 0;
};

}  // namespace crossgait
