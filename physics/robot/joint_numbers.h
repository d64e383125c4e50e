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
    JointNumber{"implicit_stiffness", "-", &Joint::implicit_stiffness, JointNumberOf::kServo, 1, false,
                "implicit_stiffness, a share"},
    JointNumber{"implicit_damping", "-", &Joint::implicit_damping, JointNumberOf::kServo, 1, false,
                "implicit_damping, a share"},
    JointNumber{"damping", "N m s/rad", &Joint::damping, JointNumberOf::kJoint, kLargestGain},
    JointNumber{"implicit_joint_damping", "-", &Joint::implicit_joint_damping, JointNumberOf::kJoint, 1,
                false, "implicit_joint_damping, a share"},
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

/// Tells whether a number is of something that a joint does without unless it is said.
constexpr bool is_off_at_zero(const JointNumber& number) noexcept {
  return number.of == JointNumberOf::kDrive || number.member == &Joint::effort_negative ||
         number.member == &Joint::implicit_stiffness || number.member == &Joint::implicit_damping ||
         number.member == &Joint::implicit_joint_damping;
}

/// A row says when in a step a servo law looks at the joint, by a simulator's name for it.
struct ServoLaw {
  std::string_view name;
  double implicit_stiffness, implicit_damping;
};

/// Servo laws by the names that files may use in the place of the two numbers. Isaac Gym's policies compute
/// explicit torques, as do Isaac Lab's IdealPDActuator and DCMotor; MuJoCo's implicit integrators take the
/// damping of actuators (kv) at the step's end; PhysX's drives and Isaac Lab's ImplicitActuator both.
inline constexpr std::array kServoLaws{ServoLaw{"explicit", 0, 0}, ServoLaw{"damping", 0, 1},
                                       ServoLaw{"drive", 1, 1}};
/// The key of a law in files.
inline constexpr std::string_view kServoLawKey = "law";

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
