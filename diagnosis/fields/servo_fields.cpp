// Servos, drives and what joints lose.
#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "diagnosis/fields/changes.h"
#include "diagnosis/fields/fields.h"
#include <fmt/format.h>

#include "physics/core/find_row.h"

namespace crossgait::fields {
namespace {

// A number of every servo set to `value`, or to the robot's own.
std::function<void(EnvConfig&)> set_servos(std::size_t row, std::optional<double> value) {
  return [row, value](EnvConfig& c) { c.servos.numbers[row] = {value, {}}; };
}

CandidateField servo_field(const Context& context, std::size_t row) {
  const JointNumber& known = kJointNumbers[row];
  const RobotDescription& robot = *context.model.world.robot;
  std::map<std::string, double> by_name;
  std::vector<double> now, own;
  for (const int i : robot.actuated_joints()) {
    by_name[robot.joint(i).name] = robot.joint(i).*known.member;
    now.push_back(robot.joint(i).*known.member);
    own.push_back(context.model.robot->joint(i).*known.member);
  }
  CandidateField field{fmt::format("servos.{}", known.name), numbers_in_words(now), {}};
  if (own != now)
    field.changes.push_back(
        {fmt::format("the robot's own, {}", numbers_in_words(own)), set_servos(row, std::nullopt)});
  const auto scale = [row, by_name](EnvConfig& c, double factor) {
    c.servos.numbers[row] = {std::nullopt, by_name};
    for (auto& [joint, value] : c.servos.numbers[row].by_name) value *= factor;
  };
  if (now != std::vector<double>(now.size(), 0))
    add_factors(field, scale, now,
                known.of == JointNumberOf::kServo ? std::vector{0.25, 0.5, 0.7, 1.4, 2.0, 4.0}
                                                  : std::vector{0.25, 4.0});
  return field;
}

std::size_t servo_row(std::string_view name) {
  return static_cast<std::size_t>(&find_row(kJointNumbers, name, "diagnosis", "servos") -
                                  kJointNumbers.data());
}

// When in a step servos look at the joints, by the laws that simulators have.
Fields servo_law(const Context& context) {
  const EnvConfig& now = context.config;
  if (now.joints.commands_torques()) return {};
  const std::size_t stiffness = servo_row("implicit_stiffness"), damping = servo_row("implicit_damping");
  const RobotDescription& robot = *context.model.world.robot;
  const auto is_of = [&robot](const ServoLaw& law) {
    const std::vector<int> servos = robot.actuated_joints();
    return std::all_of(servos.begin(), servos.end(), [&](int i) {
      return robot.joint(i).implicit_stiffness == law.implicit_stiffness &&
             robot.joint(i).implicit_damping == law.implicit_damping;
    });
  };
  const auto* own = std::find_if(kServoLaws.begin(), kServoLaws.end(), is_of);
  CandidateField field{"servos.law", own == kServoLaws.end() ? "mixed" : std::string(own->name), {}};
  for (const ServoLaw& law : kServoLaws) {
    if (&law == own) continue;
    field.changes.push_back({std::string(law.name), [=](EnvConfig& c) {
                               c.servos.numbers[stiffness] = {law.implicit_stiffness, {}};
                               c.servos.numbers[damping] = {law.implicit_damping, {}};
                             }});
  }
  return {field};
}

}  // namespace

Fields servo_gains(const Context& context) {
  Fields fields{servo_field(context, servo_row("kp")), servo_field(context, servo_row("kd"))};
  for (CandidateField& field : servo_law(context)) fields.push_back(std::move(field));
  return fields;
}

Fields servo_effort(const Context& context) { return {servo_field(context, servo_row("effort"))}; }

// Values that files have where they say any.
Fields joint_losses(const Context& context) {
  Fields fields;
  for (const auto& [name, values] : {std::pair{"armature", std::vector{0.0, 0.01, 0.03, 0.1}},
                                     {"damping", std::vector{0.0, 0.1, 0.5}},
                                     {"friction", std::vector{0.0, 0.2, 1.0}}}) {
    const std::size_t row = servo_row(name);
    CandidateField field = servo_field(context, row);
    for (const double value : values) {
      if (field.from != number(value)) field.changes.push_back({number(value), set_servos(row, value)});
    }
    fields.push_back(std::move(field));
  }
  return fields;
}

Fields drives(const Context& context) {
  Fields fields;
  for (const char* name : {"corner_speed", "no_load_speed", "backlash", "lag", "sensor_noise"}) {
    const std::size_t row = servo_row(name);
    if (context.config.servos.numbers[row].empty()) continue;
    CandidateField field = servo_field(context, row);
    field.changes.push_back({"none", set_servos(row, 0)});
    fields.push_back(std::move(field));
  }
  const std::size_t row = servo_row("delay");
  CandidateField delay = servo_field(context, row);
  for (const double value : {0.0, 0.01, 0.02}) {
    if (delay.from != number(value)) delay.changes.push_back({number(value), set_servos(row, value)});
  }
  fields.push_back(std::move(delay));
  return fields;
}

}  // namespace crossgait::fields
