// What tells one robot from another, whatever the files look like that say it.
#pragma once

#include <string>

#include "physics/robot/robot.h"

namespace crossgait {

/// Writes every number and text that a result may depend on, a line each: "bodies[3].joint.kp=35". Left out
/// are the robot's name, the file it came from, and what bodies look like.
std::string identity_text(const RobotDescription& robot);

/// Computes the SHA-256 of that text, 64 hexadecimal digits.
std::string identity_hash(const RobotDescription& robot);

}  // namespace crossgait
