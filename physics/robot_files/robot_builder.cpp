#include "physics/robot_files/robot_builder.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "physics/robot/robot_members.h"
#include "physics/robot_files/reader_warnings.h"
#include "physics/robot_files/robot_contact.h"
#include "physics/robot_files/robot_formats.h"
#include "physics/robot_files/robot_servos.h"

namespace crossgait {

namespace {

/// What the file is told: by its robot.yaml, and by the program over that.
FileArguments arguments_of(const std::string& file, const std::optional<YamlValue>& yaml) {
  FileArguments arguments = given_file_arguments();
  const auto said = yaml ? yaml->find("xacro_args") : std::nullopt;
  if (!said) return arguments;
  if (!robot_format_of_any(file).has_arguments)
    said->fail("a robot's file that is a xacro", fmt::format("'{}'", file));
  for (const auto& [name, value] : said->entries()) arguments.emplace(name, value.text());
  return arguments;
}

}  // namespace

RobotBuilder::RobotBuilder(const std::string& file, const std::string& source, std::optional<YamlValue> yaml,
                           ServoSource servos)
    : yaml_(std::move(yaml)), servos_(servos) {
  report_.arguments = arguments_of(file, yaml_);
  parsed_ = read_robot_file(file, report_.arguments);
  const auto name = find("name");
  robot_.name = name                   ? name->text()
                : parsed_.name.empty() ? std::filesystem::path(file).stem().string()
                                       : parsed_.name;
  robot_.source = source;
  report_.file = file;
  report_.warnings = parsed_.warnings;
  for (const Body& body : parsed_.bodies) report_.joints_of_file[body.joint.name] = body.joint;
  report_.reasons = parsed_.reasons;
  report_.velocity_limits = parsed_.velocity_limits;
  report_.unused = parsed_.unused;
  for (const NamedCoupling& coupling : parsed_.couplings)
    report_.couplings_of_file.emplace(coupling.follower, coupling);
  report_.contact = parsed_.contact;
  report_.loop_softness = parsed_.loop_softness;
}

LoadedRobot RobotBuilder::load() {
  try {
    return build();
  } catch (const ConfigError& error) {
    throw with_cause(error, parsed_.warnings);
  }
}

LoadedRobot RobotBuilder::build() {
  read_couplings();
  read_loops();
  read_frame_and_legs();
  take_couplings();
  take_loops();
  robot_.loop_softness = parsed_.loop_softness.value_or(robot_.loop_softness);
  read_softness("loop_softness", robot_.loop_softness);
  read_softness("friction_softness", robot_.friction_softness);
  for (Body& body : robot_.bodies) read_softness("limit_softness", body.joint.limit_softness);
  read_feet();
  robot_.contact = contact_of_feet(robot_, report_);
  if (const auto contact = find("contact")) robot_.contact.add(read_contact_settings(*contact));
  name_servos();
  warn_of_actuator_order();
  check_before_home();
  read_heights_and_home();
  read_servos(yaml_, unknown_effort_, servos_, robot_, report_);
  robot_.validate();
  return {std::move(robot_), std::move(report_)};
}

std::optional<YamlValue> RobotBuilder::find(std::string_view key) const {
  return yaml_ ? yaml_->find(key) : std::nullopt;
}

void RobotBuilder::infer(std::string what, std::string value, std::string reason) {
  report_.inferred.push_back({std::move(what), std::move(value), std::move(reason)});
}

const LinkPlacement& RobotBuilder::link(const YamlValue& value) const {
  const auto found = parsed_.links.find(value.text());
  if (found == parsed_.links.end())
    value.fail("a link of the robot's file", fmt::format("'{}'", value.text()));
  return found->second;
}

int RobotBuilder::body_of(const LinkPlacement& placement) const {
  return body_index_[static_cast<std::size_t>(placement.body)];
}

void RobotBuilder::warn_of_actuator_order() {
  const auto of_servos = [this](const std::vector<std::string>& joints) {
    std::vector<std::string> servos;
    for (const std::string& joint : joints) {
      const auto& found = std::ranges::find(robot_.bodies, joint, [](const Body& b) { return b.joint.name; });
      if (found != robot_.bodies.end() && found->joint.actuated) servos.push_back(joint);
    }
    return servos;
  };
  const std::vector<std::string> order = of_servos(parsed_.actuator_order);
  if (order.size() != robot_.actuated_joints().size() || order == of_servos(parsed_.joint_order)) return;
  report_.warnings.push_back(
      fmt::format("actuators stand in another order than joints: a policy made on ctrl has `joints: "
                  "{{order: [{}]}}` in its environment",
                  fmt::join(order, ", ")));
}

void RobotBuilder::read_loops() {
  const auto loops = find("loops");
  if (!loops) return;
  parsed_.loops.clear();
  for (const YamlValue& value : loops->items()) {
    value.allow_keys({"name", "link_a", "point_a", "link_b", "point_b"});
    for (const char* key : {"link_a", "link_b"}) static_cast<void>(link(value.at(key)));  // throws
    parsed_.loops.push_back({value.at("name").text(), value.at("link_a").text(), value.at("link_b").text(),
                             value.at("point_a").vector3(), value.at("point_b").vector3()});
  }
}

void RobotBuilder::take_loops() {
  for (const LinkLoop& loop : parsed_.loops) {
    const LinkPlacement &a = parsed_.links.at(loop.link_a), &b = parsed_.links.at(loop.link_b);
    robot_.loops.push_back({loop.name, body_of(a), body_of(b), a.X_BL * loop.p_a, b.X_BL * loop.p_b});
  }
}

void RobotBuilder::read_softness(std::string_view key, Softness& softness) {
  if (const auto values = find(key)) read_softness(*values, softness);
}

void RobotBuilder::read_softness(const YamlValue& values, Softness& softness) {
  std::vector<std::string_view> names;
  for_each_member(softness, [&](std::string_view name, double&) { names.push_back(name); });
  values.allow_keys(names);
  for_each_member(softness, [&](std::string_view name, double& member) {
    if (const auto value = values.find(name)) member = value->number();
  });
}

}  // namespace crossgait
