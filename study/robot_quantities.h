// What a robot's file says of servos, joints and contact beside what is simulated.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "physics/engine/world_spec.h"
#include "physics/robot_files/robot_report.h"

namespace crossgait {

/// Holds nothing, a number, several, or a word.
using QuantityValue = std::variant<std::monostate, double, std::vector<double>, std::string>;

struct RobotQuantity {
  std::string of;    ///< a joint, a foot ("foot FL") or "world"
  std::string name;  ///< "kp", "friction"
  std::string unit;
  QuantityValue file;  ///< what the robot's file says
  QuantityValue used;  ///< what is simulated
  std::string why;     ///< the one that is used
};

/// Lists every quantity of servos and joints, joint by joint, of the contact of feet, and of the world's
/// steps.
/// @param world  in which the robot would be
std::vector<RobotQuantity> robot_quantities(const LoadedRobot& loaded, const WorldSpec& world);

/// Lists the warnings of the robot's report and those that only a world tells: contact and steps of time of
/// the file that are not simulated, with both numbers, and servo loops for which the steps are too long.
std::vector<std::string> robot_warnings(const LoadedRobot& loaded, const WorldSpec& world);

/// Returns a world of usual steps with the contact that the robot asks for.
WorldSpec world_of(const LoadedRobot& loaded);

/// Says that steps of `dt` (s) are too long for a robot's explicit servos, with numbers; empty if they are
/// not (stiffest_servo_loop below 1).
std::string servo_loop_warning(const RobotDescription& robot, double dt);

/// Says which soft constraints are stiffer than MuJoCo's law has them in steps of `dt` (s), what is asked for
/// and what is simulated (time_constant_in_steps); empty if none is. @param contact  as asked
std::string softness_warning(const RobotDescription& robot, const ContactSpec& contact, double dt);

/// Lists both warnings of steps, those that there are. @param contact  as asked
std::vector<std::string> step_warnings(const RobotDescription& robot, const ContactSpec& contact, double dt);

/// Tabulates quantities; what is alike for several joints or feet is one row.
std::string describe(const std::vector<RobotQuantity>& quantities);
/// Writes lists of `of, name, unit, file, used, why`; nothing is null.
nlohmann::ordered_json to_json(const std::vector<RobotQuantity>& quantities);

}  // namespace crossgait
