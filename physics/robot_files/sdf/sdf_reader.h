// An SDF file, as Gazebo has them, as a tree of moving bodies.
#pragma once

#include <string>

#include "physics/robot_files/parsed_robot.h"

namespace crossgait {

/// Reads the one model of a file, or of a world, that has joints and is not static. Supports revolute,
/// continuous and fixed joints, and closes a loop at the place of every further joint of a link (also a ball
/// joint); links, joints and frames wherever poses and frames put them (sdf_model.h), included and nested
/// models, boxes, spheres, cylinders, capsules, ellipsoids and meshes, friction (sdf_contact.h) and Gazebo's
/// position controllers (sdf_servos.h); models/README.md says what becomes of the rest. What is not used of
/// the model is a warning. Links without `<inertial>` weigh 1 kg, as SDF has it, with a warning.
/// @throws ConfigError naming the file (of the SDF, of an include or a mesh), the line and the element
ParsedRobot read_sdf(const std::string& path);

}  // namespace crossgait
