// A URDF file as a tree of moving bodies.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "crossgait/physics/robot.h"

namespace crossgait {

/// Where a link of the file ended up: fixed joints are merged into the moving body they belong to.
struct LinkPlacement {
  int body = 0;                  ///< index into UrdfRobot::bodies
  Pose X_BL = Pose::Identity();  ///< pose of the link's frame in that body
  std::vector<int> shapes;       ///< indices of the link's own shapes in that body
};

struct UrdfRobot {
  /// Base first, parents before their children, siblings by joint name. A body is named after the link its
  /// joint moves and has that link's frame; joints carry axis, limits, damping and effort limit.
  std::vector<Body> bodies;
  std::map<std::string, LinkPlacement> links;  ///< every link of the file
};

/// Supports revolute, continuous and fixed joints and spheres, boxes and cylinders; anything else is an
/// error, visuals are skipped. Reads numbers alike in every locale. May be called from several threads.
/// @throws ConfigError naming the file and the line, link or joint
UrdfRobot read_urdf(const std::string& path);

}  // namespace crossgait
