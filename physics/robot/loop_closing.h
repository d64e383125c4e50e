// Finds the passive joint angles that close a robot's kinematic loops and keep its couplings.
#pragma once

#include "physics/robot/robot.h"

namespace crossgait {

/// Moves the joints without a servo, from where `q` has them, until the loops are closed and followers are
/// where they belong; servo angles stay.
/// Gauss-Newton on the gaps: from a guess well on one side of a singularity it keeps to that working mode.
/// Where the loops cannot close it ends at some best effort: check `max_loop_gap`.
/// @param q  joint angles, rad, one per joint; every one finite
void close_loops(const RobotDescription& robot, JointVector& q);

}  // namespace crossgait
