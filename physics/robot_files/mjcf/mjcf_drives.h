// What the actuators of an MJCF make of its joints' servos.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "physics/robot_files/mjcf/mjcf_actuators.h"
#include "physics/robot_files/mjcf/mjcf_model.h"
#include "physics/robot_files/parsed_robot.h"
#include "physics/robot_files/reader_warnings.h"

namespace crossgait {

/// Limits of what all actuators of a joint do to it together, N m, by joint, where they are limited
/// (`actuatorfrcrange`).
using MjcfJointForces = std::map<std::string, MjcfRange>;

/// Sets gains, torque limits, ranges of targets, lags and delays of the robot's joints by their actuators;
/// those of several on one joint add up.
///  - The torque limit is the least of |gear| x forcerange, |gear| x gain x ctrlrange (of motors alone: a
///    servo's control is an angle) and the joint's own, each where it is limited.
///  - A damping ratio z is kd = 2 z sqrt(kp M), M the inertia that the joint moves, armature included and all
///    else free, at the angles at which the file has the bodies (as MuJoCo 4.0.0 compiles it).
///  - Under an implicit integrator servos are damped at a step's end (Joint::implicit_damping).
/// @param robot  whose contact is the file's
/// @throws ConfigError for an actuator of a joint that the file does not have
void drive_joints(const std::vector<MjcfActuator>& actuators, const MjcfJointForces& forces,
                  const MjcfModel& model, const std::string& path, ParsedRobot& robot,
                  ReaderWarnings& warnings);

}  // namespace crossgait
