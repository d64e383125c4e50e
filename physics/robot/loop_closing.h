// Finds the passive joint angles that close a robot's kinematic loops and keep its couplings.
#pragma once

#include "physics/robot/robot.h"

namespace crossgait {

/// What counts as closed, m. Files whose axes are parallel to six digits cannot be closed to rounding;
/// engines hold loops softly, and 1e-5 m are a push of 0.4 m/s^2 (a time constant of 5 ms).
inline constexpr double kLoopTolerance = 1e-5;

/// Moves the joints without a servo, from where `q` has them, until the loops are closed and followers are
/// where they belong; servo angles stay.
/// Gauss-Newton on the gaps: from a guess well on one side of a singularity it keeps to that working mode.
/// Where the loops cannot close it ends at some best effort: check `max_loop_gap`.
/// @param q  joint angles, rad, one per joint; every one finite
void close_loops(const RobotDescription& robot, JointVector& q);

}  // namespace crossgait
