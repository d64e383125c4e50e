// Two descriptions of one robot, and a robot made of parts of either.
#pragma once

#include <string>
#include <vector>

#include "physics/robot/robot.h"

namespace crossgait {

/// Returns `b` in the order of `a`: its bodies and joints by the roles of the legs and then as they come,
/// under the names of `a`; joints whose axis points the other way are turned around.
/// @throws ConfigError naming `b`'s file where it has other bodies, joints or servos, or counts angles
/// from another zero
RobotDescription in_order_of(const RobotDescription& a, const RobotDescription& b);

/// Lists parts of a description: "mass properties", those of joint numbers by the groups of world_quantities
/// ("gains", "effort", "damping", ...), "softness" of loops, dry friction and joint limits, and "geometry",
/// which is all that no other part has: lengths, axes, limits, shapes, feet, home pose.
std::vector<std::string> robot_parts();
/// Lists parts in which two descriptions are not the same but for rounding (a share of 1e-9). @param b  in
/// the order of `a`
std::vector<std::string> unlike_parts(const RobotDescription& a, const RobotDescription& b);
/// Returns `a` with one part of `b`. @param b  in the order of `a`
RobotDescription with_part(const RobotDescription& a, const RobotDescription& b, const std::string& part);

}  // namespace crossgait
