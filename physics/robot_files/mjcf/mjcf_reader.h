// An MJCF file as a tree of moving bodies.
#pragma once

#include <string>

#include "physics/robot_files/urdf/urdf_reader.h"

namespace crossgait {

/// The robot of an MJCF, by the compiler of an engine (mjcf_model.h): defaults, classes, includes and units
/// mean what they mean there. models/README.md says what of a file is carried over. What is not is counted
/// (UrdfRobot::warnings) or refused by name. Prints nothing.
/// @throws ConfigError naming the file, the line and the element
UrdfRobot read_mjcf(const std::string& path);

/// Whether a path is that of an MJCF: *.xml or *.mjcf.
bool is_mjcf_path(const std::string& path);

}  // namespace crossgait
