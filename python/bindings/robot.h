// Robots as Python holds them.
#pragma once

#include <memory>
#include <string>

#include "physics/robot_files/robot_report.h"

namespace crossgait::python {

/// Immutable, and shared with whatever is made of it.
struct Robot {
  std::string from;  ///< the name or file that it was loaded by
  std::shared_ptr<const RobotDescription> description;
  RobotReport report;
};

}  // namespace crossgait::python
