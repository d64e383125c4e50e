// The keys `servos` and `joints` of an environment's YAML.
#include <array>

#include "env/env_config_yaml.h"
#include "physics/robot_files/servo_law.h"

namespace crossgait::env_yaml {
namespace {

ServoNumbers read_servo_numbers(const YamlValue& value) {
  ServoNumbers numbers;
  if (!value.is_mapping()) {
    numbers.all = value.number();
  } else {
    for (const auto& [joint, number] : value.entries()) {
      if (joint == kAllServos) {
        numbers.all = number.number();
      } else {
        numbers.by_name[joint] = number.number();
      }
    }
  }
  return numbers;
}

// What says nothing where actions command joints, and what only says something there.
constexpr std::array kGaitKeys{"gait",         "parameters",     "adapt",       "ranges",
                               "delta_scales", "residual_scale", "heading_hold"};

// One command, or by joint.
void read_commands(const YamlValue& joints, JointActionSettings& settings) {
  const std::initializer_list<JointCommand> known{JointCommand::kPosition, JointCommand::kRelative,
                                                  JointCommand::kTorque, JointCommand::kVelocity};
  const auto command = joints.find("command");
  if (!command || !command->is_mapping()) {
    read_choice(joints, "command", settings.command, known);
    return;
  }
  for (const auto& [joint, value] : command->entries())
    read_choice(*command, joint, joint == kAllServos ? settings.command : settings.commands[joint], known);
}

// A law by its name in the place of its numbers: one, or by joint.
void read_law(const YamlValue& servos, const YamlValue& law, ServoSettings& settings) {
  ServoNumbers& stiffness = settings["implicit_stiffness"];
  ServoNumbers& damping = settings["implicit_damping"];
  const auto set_all = [&](const YamlValue& name) {
    const ServoLaw& of = read_servo_law(servos, name);
    stiffness.all = of.implicit_stiffness;
    damping.all = of.implicit_damping;
  };
  if (!law.is_mapping()) return set_all(law);
  for (const auto& [joint, name] : law.entries()) {
    if (joint == kAllServos) {
      set_all(name);
      continue;
    }
    const ServoLaw& of = read_servo_law(servos, name);
    stiffness.by_name[joint] = of.implicit_stiffness;
    damping.by_name[joint] = of.implicit_damping;
  }
}

}  // namespace

void read(const YamlValue& root, std::string_view key, ServoNumbers& numbers) {
  if (const auto found = root.find(key)) numbers = read_servo_numbers(*found);
}

void read_servos(const YamlValue& root, EnvConfig& config) {
  const auto servos = root.find("servos");
  if (!servos) return;
  std::vector<std::string_view> keys =
      joint_number_names({JointNumberOf::kServo, JointNumberOf::kJoint, JointNumberOf::kDrive});
  keys.push_back(kServoLawKey);
  servos->allow_keys(keys);
  for (std::size_t i = 0; i < kJointNumbers.size(); ++i)
    read(*servos, kJointNumbers[i].name, config.servos.numbers[i]);
  if (const auto law = servos->find(kServoLawKey)) read_law(*servos, *law, config.servos);
}

void read_joints(const YamlValue& root, EnvConfig& config) {
  const auto joints = root.find("joints");
  if (config.action == ActionKind::kGait) {
    if (joints) joints->fail("this key with action: joints alone", "action: gait");
    return;
  }
  for (const char* key : kGaitKeys) {
    if (const auto value = root.find(key)) value->fail("this key with action: gait alone", "action: joints");
  }
  if (!joints) return;
  joints->allow_keys({"order", "observed", "command", "home", "offset", "scale", "lower", "upper", "limit",
                      "delay", "filter", "actuator"});
  if (const auto order = joints->find("order")) config.joints.order = read_names(*order);
  if (const auto observed = joints->find("observed")) config.joints.observed = read_names(*observed);
  read_commands(*joints, config.joints);
  if (const auto file = joints->find("actuator"))
    config.joints.actuator = resolved(file->text(), root.source(), true);
  read(*joints, "home", config.joints.home);
  read(*joints, "offset", config.joints.offset);
  read(*joints, "scale", config.joints.scale);
  read(*joints, "lower", config.joints.lower);
  read(*joints, "upper", config.joints.upper);
  read(*joints, "filter", config.joints.filter);
  read(*joints, "limit", config.joints.limit);
  read(*joints, "delay", config.joints.delay);
}

}  // namespace crossgait::env_yaml
