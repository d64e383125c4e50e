// What a viewer draws of a robot and its ground, in no viewer's terms. SI units, W with z up.
#pragma once

#include <array>
#include <vector>

#include <nlohmann/json.hpp>

#include "physics/robot/robot.h"
#include "physics/terrain/terrain.h"
#include "report/page_numbers.h"

namespace crossgait {

/// Says where bases went, seen from above, m.
struct PathBounds {
  std::array<double, 2> min{0, 0}, max{0, 0};
};

/// Writes the keys `robot`, `bodies` (`name`, `mass`, `centre_of_mass`, `shapes`, `collision`: the shapes
/// that collide, `inertia`: a box of even density with its mass and moments), `meshes`, `legs` (`name`,
/// `body`, `foot`: its centre in the body's frame, `radius`, `origin`: of the leg frame in the base, or
/// null), `ground` (null for a plane) and `notes`, what is shown otherwise than it is. A shape has `type`
/// (sphere, box, cylinder, capsule, mesh, hull), `size` as VisualShape's, its pose in the body's frame
/// (`position`, `quaternion` x, y, z, w), `rgba` or null, and `mesh`, an index, with `scale`. Bodies without
/// a visual shape that can be shown have their collision shapes.
/// @throws ConfigError for a mesh that cannot be read
nlohmann::ordered_json scene_document(const RobotDescription& robot, const Terrain& terrain,
                                      const PathBounds& path, PageNumbers& numbers);

}  // namespace crossgait
