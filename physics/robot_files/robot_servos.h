// Armature, gains and torque limits of a robot, from its robot.yaml or inferred. Private to robot_loader.
#pragma once

#include <optional>
#include <set>

#include "physics/core/yaml_reader.h"
#include "physics/robot_files/robot_report.h"

namespace crossgait {

/// @param yaml            its keys `armature`, `servo`, `drive` and `joints`, each of them if it is there
/// @param unknown_effort  servos whose torque limit the robot's file does not say
/// @param source          of the gains: the rule takes the place of what either file says
/// @param report          is told what was inferred, and warned where the rule takes the place of the file
/// @throws ConfigError naming file and key
void read_servos(const std::optional<YamlValue>& yaml, const std::set<int>& unknown_effort,
                 ServoSource source, RobotDescription& robot, RobotReport& report);

}  // namespace crossgait
