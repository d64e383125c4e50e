// Pictures of a walk, from its trace.
#pragma once

#include <string>
#include <vector>

#include "apps/plotting.h"
#include "motion/trace_table.h"
#include "physics/robot/robot.h"

namespace crossgait::apps {

/// Which feet were on the ground when, and when the gait meant them to be: one bar per stance.
/// @param shortest  touches, and gaps between them, that are shorter are left out, s
std::vector<Figure::Row> gait_rows(const TraceTable& trace, double shortest);
/// Height, roll and pitch, speed forward and to the left, yaw rate of the base.
std::vector<Figure::Row> attitude_rows(const TraceTable& trace);
/// Angles of the servos and their targets, a panel per leg.
std::vector<Figure::Row> joint_rows(const TraceTable& trace, const RobotDescription& robot);
/// Paths of the feet in the leg frames, seen from the side, a panel per leg. Positions are those of the foot
/// bodies at the traced joint angles.
std::vector<Figure::Row> feet_rows(const TraceTable& trace, const RobotDescription& robot);
/// Names of the columns "param.<name>" that hold one value throughout.
std::vector<std::string> constant_parameters(const TraceTable& trace);
/// The columns "param.<name>", a panel each; empty if there is none. @param constant_too  also those that
/// never change
std::vector<Figure::Row> parameter_rows(const TraceTable& trace, bool constant_too);

}  // namespace crossgait::apps
