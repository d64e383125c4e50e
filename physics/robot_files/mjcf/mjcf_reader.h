// An MJCF file as a tree of moving bodies.
#pragma once

#include <string>

#include "physics/robot_files/parsed_robot.h"

namespace crossgait {

/// Reads the robot of an MJCF, by the compiler of an engine (mjcf_model.h): defaults, classes, includes and
/// units mean what they mean there. models/README.md says what of a file is carried over. What is not is
/// counted (ParsedRobot::warnings) or refused by name. Prints nothing.
/// @throws ConfigError naming the file, the line and the element
ParsedRobot read_mjcf(const std::string& path);

}  // namespace crossgait
