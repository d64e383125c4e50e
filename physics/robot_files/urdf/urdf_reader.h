// A URDF file as a tree of moving bodies.
#pragma once

#include <string>

#include "physics/robot_files/parsed_robot.h"

namespace crossgait {

/// Reads a URDF of revolute, continuous and fixed joints, a floating one below a massless root, and spheres,
/// boxes, cylinders, capsules and meshes (mesh_shape.h); models/README.md says what becomes of the rest.
/// Prints nothing. Reads numbers alike in every locale. May be called from several threads.
/// @throws ConfigError naming the file (of the URDF or a mesh) and the line, link or joint
ParsedRobot read_urdf(const std::string& path);
/// The same of a text that stands in the place of the file `path`, which is not read.
ParsedRobot read_urdf_text(const std::string& text, const std::string& path);

}  // namespace crossgait
