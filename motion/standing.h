// Where a robot's base has to be for its feet to touch the ground.
#pragma once

#include <string_view>

#include "motion/controller.h"
#include "physics/robot/robot.h"

namespace crossgait {

/// Returns the robot at rest with these joint angles (rad), where `placement` says, so high that no foot is
/// below `terrain` and the nearest one just clear of it.
RobotState standing_on(const Terrain& terrain, const Placement& placement, const RobotDescription& robot,
                       const JointVector& q);

/// Returns joint angles (rad) with the joints of legs that no servo drives where the servos' `q` have them.
/// @param element  what set the angles, for messages
/// @throws ConfigError naming the robot's file and a leg whose chains cannot meet
JointVector with_legs_closed(const RobotDescription& robot, JointVector q, std::string_view element);

}  // namespace crossgait
