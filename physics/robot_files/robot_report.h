// A robot and what its files did not say.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "physics/robot/robot.h"
#include "physics/robot_files/contact_of_file.h"
#include "physics/robot_files/file_arguments.h"
#include "physics/robot_files/inference/robot_inference.h"
#include "physics/robot_files/parsed_robot.h"

namespace crossgait {

struct RobotReport {
  std::vector<Inference> inferred;
  std::vector<std::string> warnings;     ///< of the reader and of the inference, each once
  std::string file;                      ///< of one of the formats (robot_formats.h)
  FileArguments arguments;               ///< what that file was told
  std::map<std::string, double> locked;  ///< joints that are held, and at which angle, rad
  Matrix3 R_BA = Matrix3::Identity();    ///< columns: forward, left and up in the file's base frame
  /// Joints with the numbers of the robot's file alone, by name; 0 is not given.
  std::map<std::string, Joint> joints_of_file;
  /// Why a joint has a number that it has, by joint and number (joint_numbers.h); of those that are not there
  /// the file says it.
  std::map<std::string, std::map<std::string, std::string>> reasons;
  std::map<std::string, double> velocity_limits;   ///< of the file, by joint, rad/s; not simulated
  std::vector<UnusedQuantity> unused;              ///< of the file
  std::map<std::string, NamedCoupling> couplings;  ///< those that are simulated, by their follower
  /// Those that the robot's file says, simulated or not, by their follower.
  std::map<std::string, NamedCoupling> couplings_of_file;
  ContactOfFile contact;
  std::optional<Softness> loop_softness;    ///< of the file
  std::map<Leg, std::string> feet_of_file;  ///< the shape of the file nearest to a foot, where there is one
};

struct LoadedRobot {
  RobotDescription robot;
  RobotReport report;
};

/// Says where the gains of servos come from.
enum class ServoSource {
  kFile,  ///< the robot's files; the rule for what they do not say
  kRule,  ///< the rule (servo_rule), whatever they say. Torque limits stay theirs
};

/// Says where robots have their gains from unless who reads them says: `kFile` until it is set, once, by a
/// program before it reads any (`--servos`).
ServoSource servo_source() noexcept;
void set_servo_source(ServoSource source) noexcept;

/// Loads a robot as `load_robot`, with what was inferred and why.
LoadedRobot load_robot_with_report(const std::string& path, ServoSource servos = servo_source());

/// Writes the whole robot.yaml: with it beside the robot's file nothing is inferred, and the robot is the
/// same but for rounding in the 17th digit. @param file  what the key of its format says
std::string to_yaml(const LoadedRobot& loaded, const std::string& file);

}  // namespace crossgait
