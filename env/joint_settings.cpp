#include "env/joint_settings.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "physics/core/find_row.h"
#include "physics/robot/robot_check.h"

namespace crossgait {
namespace {

std::vector<std::string> servo_names(const RobotDescription& robot) {
  std::vector<std::string> names;
  for (const int i : robot.actuated_joints()) names.push_back(robot.joint(i).name);
  return names;
}

void check_names(const ServoNumbers& numbers, const std::vector<std::string>& servos, std::string_view source,
                 std::string_view element) {
  for (const auto& [name, value] : numbers.by_name) {
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

}  // namespace

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
    check_names(numbers[i], servos, source, fmt::format("servos.{}", kJointNumbers[i].name));
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
  check_names(settings.home, servos, source, "joints.home");
  check_names(settings.scale, servos, source, "joints.scale");
  check_names(settings.offset, servos, source, "joints.offset");
  check_names(settings.lower, servos, source, "joints.lower");
  check_names(settings.upper, servos, source, "joints.upper");
  if (!settings.order.empty()) check_order(settings.order, servos, source);
  constexpr double kUnbounded = std::numeric_limits<double>::infinity();
  JointActionTable table;
  table.command = settings.command;
  for (const std::string& name : settings.order.empty() ? servos : settings.order) {
    const std::vector<int> indices = robot.actuated_joints();
    const int servo =
        *std::find_if(indices.begin(), indices.end(), [&](int i) { return robot.joint(i).name == name; });
    const double home = settings.home.find(name).value_or(robot.home[servo]);
    const Joint& joint = robot.joint(servo);
    if (!(home >= joint.lower && home <= joint.upper))
      throw ConfigError(source, fmt::format("joints.home of {}", name),
                        fmt::format("an angle within its limits, [{:g}, {:g}] rad", joint.lower, joint.upper),
                        fmt::format("{:g}", home));
    if (settings.command == JointCommand::kTorque && !(joint.kp > 0))
      throw ConfigError(source, fmt::format("servos.kp of {}", name),
                        "a stiffness above 0, by which its servo is made to give a torque",
                        fmt::format("{:g}", joint.kp));
    table.servos.push_back(servo);
    table.slots.push_back(std::find(indices.begin(), indices.end(), servo) - indices.begin());
    table.home.push_back(home);
    table.offset.push_back(settings.offset.find(name).value_or(home));
    table.scale.push_back(settings.scale.find(name).value_or(*JointActionSettings{}.scale.all));
    table.lower.push_back(settings.lower.find(name).value_or(-kUnbounded));
    table.upper.push_back(settings.upper.find(name).value_or(kUnbounded));
    if (!(table.lower.back() <= table.upper.back()))
      throw ConfigError(source, fmt::format("joints.lower of {}", name),
                        fmt::format("at most its upper, {:g} rad", table.upper.back()),
                        fmt::format("{:g}", table.lower.back()));
  }
  return table;
}

std::string JointActionTable::target_unit(std::size_t i) const {
  if (command == JointCommand::kTorque) return fmt::format("{:g} N m", scale[i]);
  const std::string unit = fmt::format("{:g} rad", scale[i]);
  if (command == JointCommand::kRelative) return unit + " from where it is";
  return measured_from(unit, offset.empty() ? home[i] : offset[i]);
}

// A thousandth of a radian tells one zero from another, and is beyond what machines round apart.
std::string measured_from(std::string_view unit, double zero) {
  return fmt::format("{} from {:.3f}", unit, std::round(1e3 * zero) / 1e3 + 0.0);  // no "-0.000"
}

std::string_view name(JointCommand command) noexcept {
  constexpr std::array<std::string_view, 3> kNames{"position", "relative", "torque"};
  return kNames[static_cast<std::size_t>(command)];
}

}  // namespace crossgait
