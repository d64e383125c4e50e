// A robot and what its files did not say.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "physics/robot/robot.h"
#include "physics/robot_files/inference/robot_inference.h"

namespace crossgait {

struct RobotReport {
  std::vector<Inference> inferred;
  std::vector<std::string> warnings;   ///< of the reader and of the inference, each once
  std::string file;                    ///< of one of the formats (robot_formats.h)
  std::set<std::string> locked;        ///< joints held at zero
  Matrix3 R_BA = Matrix3::Identity();  ///< columns: forward, left and up in the file's base frame
};

struct LoadedRobot {
  RobotDescription robot;
  RobotReport report;
};

/// As `load_robot`, with what was inferred and why.
LoadedRobot load_robot_with_report(const std::string& path);

/// The whole robot.yaml: with it beside the robot's file nothing is inferred, and the robot is the same but
/// for rounding in the 17th digit. @param file  what the key of its format says
std::string to_yaml(const LoadedRobot& loaded, const std::string& file);

}  // namespace crossgait
