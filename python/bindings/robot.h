// Robots as Python holds them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "physics/robot_files/robot_report.h"

namespace crossgait::python {

/// Holds a robot that is immutable, and shared with whatever is made of it.
struct Robot {
  std::string from;  ///< the name or file that it was loaded by
  std::shared_ptr<const RobotDescription> description;
  RobotReport report;
};

/// Reads a robot by its name or file. @throws ConfigError
Robot load(const std::string& name_or_file);

std::vector<std::string> joint_names(const RobotDescription& robot, bool actuated_only);
std::vector<std::string> body_names(const RobotDescription& robot);
/// @throws ConfigError naming `source`, listing the names
int body_index(const RobotDescription& robot, const std::string& name, const std::string& source);

}  // namespace crossgait::python
