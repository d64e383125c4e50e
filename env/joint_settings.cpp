#include "env/joint_settings.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "motion/standing.h"
#include "physics/core/error.h"
#include "physics/core/find_row.h"
#include "physics/robot/actuator.h"
#include "physics/robot/robot_check.h"

namespace crossgait {
namespace {

std::vector<std::string> servo_names(const RobotDescription& robot) {
  std::vector<std::string> names;
  for (const int i : robot.actuated_joints()) names.push_back(robot.joint(i).name);
  return names;
}

template <typename Value>
void check_names(const std::map<std::string, Value>& by_name, const std::vector<std::string>& servos,
                 std::string_view source, std::string_view element) {
  for (const auto& [name, value] : by_name) {
    if (std::find(servos.begin(), servos.end(), name) == servos.end())
      throw ConfigError(source, element, fmt::format("servos of the robot: {}", fmt::join(servos, ", ")),
                        fmt::format("'{}'", name));
  }
}

void check_order(const std::vector<std::string>& order, std::vector<std::string> servos,
                 std::string_view source) {
  std::vector<std::string> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  std::sort(servos.begin(), servos.end());
  if (sorted == servos) return;
  throw ConfigError(source, "joints.order",
                    fmt::format("each servo of the robot once: {}", fmt::join(servos, ", ")),
                    fmt::format("{}", fmt::join(order, ", ")));
}

int joint_index(const RobotDescription& robot, const std::string& name) {
  for (int i = 0; i < robot.joint_count(); ++i) {
    if (robot.joint(i).name == name) return i;
  }
  return -1;
}

void check_stiffness(const JointActionSettings& settings, const Joint& joint, std::string_view source) {
  if (settings.computes_torque(joint.name) && !(joint.kp > 0))
    throw ConfigError(source, fmt::format("servos.kp of {}", joint.name),
                      "a stiffness above 0, by which its servo is made to give a torque",
                      fmt::format("{:g}", joint.kp));
  if (settings.computes_torque(joint.name) && is_implicit(joint))
    throw ConfigError(source, fmt::format("servos of {}", joint.name),
                      "an explicit servo (law: explicit), which makes the torque that it is given",
                      fmt::format("implicit_stiffness {:g}, implicit_damping {:g}", joint.implicit_stiffness,
                                  joint.implicit_damping));
  if (settings.command_of(joint.name) == JointCommand::kVelocity && !(joint.kd > 0))
    throw ConfigError(source, fmt::format("servos.kd of {}", joint.name),
                      "a damping above 0, by which its servo follows a velocity",
                      fmt::format("{:g}", joint.kd));
}

// What observations show of joints, where that is not the action's order.
void observe_joints(JointActionTable& table, const JointActionSettings& settings,
                    const RobotDescription& robot, std::string_view source) {
  if (settings.observed.empty()) {
    table.observed = table.servos;
    table.observed_home = table.home;
    table.observed_slots = table.slots;
    return;
  }
  JointVector home = robot.home;
  for (std::size_t i = 0; i < table.servos.size(); ++i) home[table.servos[i]] = table.home[i];
  home = with_legs_closed(robot, home, "joints.home");
  for (const std::string& name : settings.observed) {
    const int joint = joint_index(robot, name);
    if (joint < 0 || std::find(table.observed.begin(), table.observed.end(), joint) != table.observed.end())
      throw ConfigError(source, "joints.observed", "joints of the robot, each once",
                        fmt::format("'{}'{}", name, joint < 0 ? "" : " twice"));
    const auto servo = std::find(table.servos.begin(), table.servos.end(), joint);
    table.observed.push_back(joint);
    table.observed_home.push_back(home[joint]);
    table.observed_slots.push_back(servo == table.servos.end()
                                       ? -1
                                       : table.slots[static_cast<std::size_t>(servo - table.servos.begin())]);
  }
}

}  // namespace

bool JointActionSettings::commands_torques() const noexcept {
  const auto computed = [](JointCommand one) {
    return one == JointCommand::kTorque || one == JointCommand::kVelocity;
  };
  return !actuator.empty() || computed(command) ||
         std::any_of(commands.begin(), commands.end(), [&](const auto& of) { return computed(of.second); });
}

bool JointActionSettings::computes_torque(const std::string& joint) const {
  const JointCommand of = command_of(joint);
  return !actuator.empty() || of == JointCommand::kTorque || of == JointCommand::kVelocity;
}

JointCommand JointActionSettings::command_of(const std::string& joint) const {
  const auto it = commands.find(joint);
  return it == commands.end() ? command : it->second;
}

std::optional<double> ServoNumbers::find(const std::string& joint) const {
  const auto it = by_name.find(joint);
  return it == by_name.end() ? all : it->second;
}

ServoNumbers& ServoSettings::operator[](std::string_view name) {
  const JointNumber& row = find_row(kJointNumbers, name, "servos", "name");
  return numbers[static_cast<std::size_t>(&row - kJointNumbers.data())];
}

bool ServoSettings::empty() const noexcept { return *this == ServoSettings(); }

void ServoSettings::apply(RobotDescription& robot, std::string_view source) const {
  const std::vector<std::string> servos = servo_names(robot);
  for (std::size_t i = 0; i < kJointNumbers.size(); ++i) {
    check_names(numbers[i].by_name, servos, source, fmt::format("servos.{}", kJointNumbers[i].name));
    for (Body& body : robot.bodies) {
      if (!body.joint.actuated) continue;
      if (const auto value = numbers[i].find(body.joint.name))
        set_number(kJointNumbers[i], *value, body.joint);
    }
  }
  for (std::size_t i = 1; i < robot.bodies.size(); ++i) check_joint(robot.bodies[i].joint, source);
}

JointActionTable JointActionTable::make(const JointActionSettings& settings, const RobotDescription& robot,
                                        std::string_view source) {
  const std::vector<std::string> servos = servo_names(robot);
  for (const auto& [numbers, element] : {std::pair{&settings.home, "joints.home"},
                                         {&settings.scale, "joints.scale"},
                                         {&settings.offset, "joints.offset"},
                                         {&settings.lower, "joints.lower"},
                                         {&settings.upper, "joints.upper"}})
    check_names(numbers->by_name, servos, source, element);
  check_names(settings.commands, servos, source, "joints.command");
  if (!settings.order.empty()) check_order(settings.order, servos, source);
  constexpr double kUnbounded = std::numeric_limits<double>::infinity();
  JointActionTable table;
  for (const std::string& name : settings.order.empty() ? servos : settings.order) {
    const std::vector<int> indices = robot.actuated_joints();
    const int servo =
        *std::find_if(indices.begin(), indices.end(), [&](int i) { return robot.joint(i).name == name; });
    const double home = settings.home.find(name).value_or(robot.home[servo]);
    const Joint& joint = robot.joint(servo);
    if (!(home >= joint.lower && home <= joint.upper))
      throw ConfigError(
          source, fmt::format("joints.home of {}", name),
          fmt::format("an angle within its limits, [{:g}, {:g}] rad (what actions count from is "
                      "`offset`)",
                      joint.lower, joint.upper),
          fmt::format("{:g}", home));
    check_stiffness(settings, joint, source);
    table.commands.push_back(settings.command_of(name));
    table.servos.push_back(servo);
    table.slots.push_back(std::find(indices.begin(), indices.end(), servo) - indices.begin());
    table.home.push_back(home);
    table.offset.push_back(settings.offset.find(name).value_or(home));
    table.scale.push_back(settings.scale.find(name).value_or(*JointActionSettings{}.scale.all));
    table.lower.push_back(settings.lower.find(name).value_or(-kUnbounded));
    table.upper.push_back(settings.upper.find(name).value_or(kUnbounded));
    if (!(table.lower.back() <= table.upper.back()))
      throw ConfigError(source, fmt::format("joints.lower of {}", name),
                        fmt::format("at most its upper, {:g}", table.upper.back()),
                        fmt::format("{:g}", table.lower.back()));
  }
  observe_joints(table, settings, robot, source);
  return table;
}

std::string JointActionTable::target_unit(std::size_t i) const {
  const JointCommand command = commands.empty() ? JointCommand::kPosition : commands[i];
  if (command == JointCommand::kTorque) return fmt::format("{:g} N m", scale[i]);
  if (command == JointCommand::kVelocity) return fmt::format("{:g} rad/s", scale[i]);
  const std::string unit = fmt::format("{:g} rad", scale[i]);
  if (command == JointCommand::kRelative) return unit + " from where it is";
  return measured_from(unit, offset.empty() ? home[i] : offset[i]);
}

// A thousandth of a radian tells one zero from another, and is beyond what machines round apart.
std::string measured_from(std::string_view unit, double zero) {
  return fmt::format("{} from {:.3f}", unit, std::round(1e3 * zero) / 1e3 + 0.0);  // no "-0.000"
}

std::string_view name(JointCommand command) noexcept {
  constexpr std::array<std::string_view, 4> kNames{"position", "relative", "torque", "velocity"};
  return kNames[static_cast<std::size_t>(command)];
}

}  // namespace crossgait
