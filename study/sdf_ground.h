// The ground of an SDF's world as a height field.
#pragma once

#include <string>

#include "study/scene_terrain.h"

namespace crossgait {

/// Samples from above the `<static>` models of an SDF's worlds: planes, boxes, spheres, capsules, cylinders
/// and height maps that collide, and of meshes their convex hulls, as `read_scene_terrain` samples an MJCF's.
/// Other models, the robot among them, are left out. Source of what elements mean: SDFormat
/// specification 1.12, "geometry"; a height map's lightest sample is as high as its `size` says, and black is
/// 0 (gz::common::ImageHeightmap).
/// @param cell  m  @throws ConfigError naming file and element, as `read_scene_terrain` does, for height maps
/// of other pictures than PNG and for poses of models that are relative to something
SceneTerrain read_sdf_ground(const std::string& path, double cell);

}  // namespace crossgait
