// Armature, gains and torque limits of a robot, from its robot.yaml or inferred. Private to robot_loader.
#pragma once

#include <optional>
#include <set>
#include <vector>

#include "physics/core/yaml_reader.h"
#include "physics/robot_files/inference/robot_inference.h"

namespace crossgait {

/// @param yaml            its keys `armature`, `servo`, `drive` and `joints`, each of them if it is there
/// @param unknown_effort  servos whose torque limit the robot's file does not say
/// @throws ConfigError naming file and key
void read_servos(const std::optional<YamlValue>& yaml, const std::set<int>& unknown_effort,
                 RobotDescription& robot, std::vector<Inference>& inferred);

}  // namespace crossgait
