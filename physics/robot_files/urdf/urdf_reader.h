// A URDF file as a tree of moving bodies.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "physics/robot/robot.h"

namespace crossgait {

/// Where a link of the file ended up: fixed joints are merged into the moving body they belong to.
struct LinkPlacement {
  int body = 0;                  ///< index into UrdfRobot::bodies
  Pose X_BL = Pose::Identity();  ///< pose of the link's frame in that body
  std::vector<int> shapes;       ///< indices of the link's own shapes in that body
};

/// Two points of two links that coincide.
struct LinkLoop {
  std::string name, link_a, link_b;
  Vector3 p_a = Vector3::Zero(), p_b = Vector3::Zero();  ///< each in its link's frame, m
};

/// What a URDF says; or an MJCF, whose bodies are links here (mjcf_reader.h).
struct UrdfRobot {
  std::string name;  ///< of the element `robot`
  /// Base first, parents before their children, siblings by joint name. A body is named after the link its
  /// joint moves and has that link's frame; joints carry axis, limits, damping and effort limit.
  std::vector<Body> bodies;
  std::map<std::string, LinkPlacement> links;  ///< every link of the file that is simulated
  /// What was left out, taken for something else or repaired: one sentence per kind of thing, counted.
  std::vector<std::string> warnings;
  /// Vertices of collision meshes in the frame of their body, m, by the name of the shape that stands for the
  /// mesh.
  std::map<std::string, std::vector<Vector3>> mesh_vertices;
  // What a URDF cannot say. Likewise kp, kd and armature of joints; 0 is not given.
  std::vector<LinkLoop> loops;
  std::map<std::string, double> home;  ///< angles by joint, rad; empty if not given
  std::string home_name;               ///< of the pose, for people
};

/// Supports revolute, continuous and fixed joints, a floating one below a massless root, and spheres, boxes,
/// cylinders, capsules and meshes (mesh_shape.h); models/README.md says what becomes of the rest. Prints
/// nothing. Reads numbers alike in every locale. May be called from several threads.
/// @throws ConfigError naming the file (of the URDF or a mesh) and the line, link or joint
UrdfRobot read_urdf(const std::string& path);

}  // namespace crossgait
