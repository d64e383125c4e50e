// Servos that an SDF's plug-ins are.
#pragma once

#include <string>

#include "physics/robot_files/parsed_robot.h"
#include "physics/robot_files/reader_warnings.h"
#include "physics/robot_files/sdf/sdf_model.h"

namespace crossgait {

/// Takes stiffness, damping and torque limits of joints from Gazebo's JointPositionController: torque =
/// p_gain (target - angle) - d_gain speed, between cmd_min and cmd_max, where its defaults are 1, 0.01 and
/// +-1000; the lesser of that limit and the joint's counts. Integral gains and offsets are not simulated, and
/// counted, as is one that commands speeds. No other plug-in is run: they are listed. @throws ConfigError
/// naming the element for a joint that does not move
void read_servos_of(const SdfModel& model, const std::string& main_file, ParsedRobot& robot,
                    ReaderWarnings& warnings);

}  // namespace crossgait
