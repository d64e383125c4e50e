// What is doubtful of a robot's legs: servos, home pose, feet, and how they lie in the base's frame.
#pragma once

#include <vector>

#include "study/robot_findings.h"

namespace crossgait {

/// Requires legs.
std::vector<RobotFinding> leg_findings(const RobotDescription& robot);
/// Lists in what left legs are no mirror images of right ones. Requires legs.
std::vector<RobotFinding> side_findings(const RobotDescription& robot);

}  // namespace crossgait
