// The ground of a scene, an MJCF or an SDF, as a height field.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "physics/terrain/height_field.h"

namespace crossgait {

struct SceneTerrain {
  std::shared_ptr<const HeightField> field;
  double overhang_ratio = 0;  ///< of the samples: below the surface there is air, and then more ground
  std::vector<std::string> warnings;  ///< what was left out or taken for something else, and overhangs
};

/// Samples from above what is fixed to the world: planes, boxes, spheres, capsules, cylinders and height
/// fields that collide, and of meshes their convex hulls, as MuJoCo collides them (of at most kMeshCorners
/// corners). Bodies on which joints hang, the robot, are left out. Samples stand `cell` apart around the
/// world's origin; a height is the world's z of the highest point over (x, y). The field reaches as far as
/// shapes do; planes are under it all. Files of SDF are read by sdf_ground.h.
/// Source of what elements mean: MuJoCo, XML reference, "geom" and "asset/hfield".
/// @param cell  m  @throws ConfigError naming file and element: no shape beside a plane, a plane or height
/// field that lies on its side, too many samples
SceneTerrain read_scene_terrain(const std::string& path, double cell);
inline constexpr int kMeshCorners = 32;

}  // namespace crossgait
