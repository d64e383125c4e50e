// The table of a joint's numbers that files may set: what reads, writes, checks and counts them goes by it.
#pragma once

#include <algorithm>
#include <array>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "physics/robot/robot.h"
#include "physics/robot/robot_check.h"

namespace crossgait {

/// Says whose number it is, and so where files say it.
enum class JointNumberOf {
  kServo,  ///< a servo's gains and torque: key `servo` of a robot.yaml
  kJoint,  ///< any joint's
  kDrive,  ///< what a servo's drive falls short of, off unless it is said: key `drive`
};

/// A row says a number's name in files, its unit, and where it is kept.
struct JointNumber {
  std::string_view name, unit;
  double Joint::*member;
  JointNumberOf of;
  double most;                  ///< largest that makes sense (robot_check.h)
  bool positive = false;        ///< zero makes no sense either
  std::string_view words = {};  ///< in messages, in the place of name and unit
};

/// Numbers of joints, in the order in which environments write them.
inline constexpr std::array kJointNumbers{
    JointNumber{"kp", "N m/rad", &Joint::kp, JointNumberOf::kServo, kLargestGain},
    JointNumber{"kd", "N m s/rad", &Joint::kd, JointNumberOf::kServo, kLargestGain},
    JointNumber{"effort", "N m", &Joint::effort_limit, JointNumberOf::kServo, kLargestGain, true,
                "effort limit (N m) of a servo"},
    JointNumber{"effort_negative", "N m", &Joint::effort_negative, JointNumberOf::kServo, kLargestGain},
    JointNumber{"damping", "N m s/rad", &Joint::damping, JointNumberOf::kJoint, kLargestGain},
    JointNumber{"stiffness", "N m/rad", &Joint::stiffness, JointNumberOf::kJoint, kLargestGain},
    JointNumber{"armature", "kg m^2", &Joint::armature, JointNumberOf::kJoint, kLargestInertia},
    JointNumber{"friction", "N m", &Joint::friction, JointNumberOf::kJoint, kLargestGain},
    JointNumber{"corner_speed", "rad/s", &Joint::corner_speed, JointNumberOf::kDrive, kLargestGain},
    JointNumber{"no_load_speed", "rad/s", &Joint::no_load_speed, JointNumberOf::kDrive, kLargestGain},
    JointNumber{"backlash", "rad", &Joint::backlash, JointNumberOf::kDrive, kLargestAngle},
    JointNumber{"delay", "s", &Joint::delay, JointNumberOf::kDrive, kLongestDelay},
    JointNumber{"lag", "s", &Joint::lag, JointNumberOf::kDrive, kLongestDelay},
    JointNumber{"sensor_noise", "rad", &Joint::sensor_noise, JointNumberOf::kDrive, kLargestAngle},
};

/// Sets a number of a joint. A torque limit is that of both directions unless the other one is set after it.
inline void set_number(const JointNumber& number, double value, Joint& joint) {
  joint.*number.member = value;
  if (number.member == &Joint::effort_limit) joint.effort_negative = 0;
}

/// Lists the names of the rows of some kinds.
inline std::vector<std::string_view> joint_number_names(std::initializer_list<JointNumberOf> kinds) {
  std::vector<std::string_view> names;
  for (const JointNumber& number : kJointNumbers) {
    if (std::find(kinds.begin(), kinds.end(), number.of) != kinds.end()) names.push_back(number.name);
  }
  return names;
}

}  // namespace crossgait
