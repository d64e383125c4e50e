// Where a robot's base has to be for its feet to touch the ground.
#pragma once

#include "motion/controller.h"
#include "physics/robot/robot.h"

namespace crossgait {

/// Returns the robot at rest with these joint angles (rad), where `placement` says, so high that no foot is
/// below `terrain` and the nearest one just clear of it.
RobotState standing_on(const Terrain& terrain, const Placement& placement, const RobotDescription& robot,
                       const JointVector& q);

}  // namespace crossgait
