#include "physics/robot_files/sdf/sdf_servos.h"

#include <algorithm>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/robot_files/sdf/sdf_values.h"

namespace crossgait {
namespace {

constexpr double kUsualP = 1, kUsualI = 0.1, kUsualD = 0.01, kUsualLimit = 1000;
constexpr const char* kController = "JointPositionController";

/// gz::sim::systems::JointPositionController, of whichever release, in whichever way it is named.
bool is_position_controller(const SdfElement& plugin) {
  const std::string name = plugin.attribute("name"), file = plugin.attribute("filename");
  return name.ends_with(kController) || file.find("joint-position-controller-system") != std::string::npos;
}

Joint* find_joint(const std::string& name, ParsedRobot& robot) {
  for (std::size_t i = 1; i < robot.bodies.size(); ++i)
    if (robot.bodies[i].joint.name == name) return &robot.bodies[i].joint;
  return nullptr;
}

void read_gains_of(const SdfElement& plugin, const std::string& place, Joint& joint, ParsedRobot& robot) {
  joint.kp = sdf_size(plugin, "p_gain", kUsualP);
  joint.kd = sdf_size(plugin, "d_gain", kUsualD);
  robot.servos.insert(joint.name);
  auto& reasons = robot.reasons[joint.name];
  reasons["kp"] = fmt::format("p_gain of {}", place);
  reasons["kd"] = fmt::format("d_gain of {}", place);
  if (plugin.find("cmd_max") == nullptr && plugin.find("cmd_min") == nullptr) return;
  const double most = sdf_size(plugin, "cmd_max", kUsualLimit);
  const double least = sdf_number(plugin, "cmd_min", -kUsualLimit);
  if (least > 0) fail_at(*plugin.find("cmd_min"), "a number up to 0", fmt::format("{}", least));
  const double of_joint = joint.effort_limit > 0 ? joint.effort_limit : kUsualLimit;
  joint.effort_limit = std::min(most, of_joint);
  joint.effort_negative = std::min(-least, of_joint);
  reasons["effort"] = fmt::format("the lesser of cmd_max and cmd_min of {} and the joint's limit", place);
}

void read_controller(const SdfPlugin& controller, const std::string& main_file, ParsedRobot& robot,
                     ReaderWarnings& warnings) {
  const SdfElement& plugin = *controller.element;
  const std::string place = fmt::format("the {} (line {})", kController, plugin.line);
  for (const char* tag : {"topic", "sub_topic", "joint_index", "initial_position", "i_max", "i_min"})
    plugin.pass_over(tag);
  const double i_gain = sdf_number(plugin, "i_gain", kUsualI);
  plugin.pass_over("cmd_offset", {"0", "0.0"});
  const bool commands_speed = sdf_flag(plugin, "use_velocity_commands", false);
  const auto joints = plugin.all("joint_name");
  if (joints.empty()) fail_at(plugin, "an element <joint_name>", "none");
  for (const SdfElement* name : joints) {
    Joint* joint = find_joint(controller.scope + name->text, robot);
    if (joint == nullptr)
      fail_at(*name, "a moving joint of the model", fmt::format("'{}'", printable_text(name->text, 200)));
    if (commands_speed) {
      warnings.count("left out ", fmt::format(" {} that command speeds", kController),
                     sdf_place(*name, main_file));
      plugin.pass_over("p_gain"), plugin.pass_over("d_gain");
      plugin.pass_over("cmd_max"), plugin.pass_over("cmd_min");
      continue;
    }
    read_gains_of(plugin, place, *joint, robot);
    if (i_gain != 0)
      warnings.count(
          "left out ",
          fmt::format(" integral gain(s) of {} (i_gain, {:g} where it is not said)", kController, kUsualI),
          sdf_place(*name, main_file));
  }
}

}  // namespace

void read_servos_of(const SdfModel& model, const std::string& main_file, ParsedRobot& robot,
                    ReaderWarnings& warnings) {
  for (const SdfPlugin& plugin : model.plugins) {
    if (is_position_controller(*plugin.element)) {
      read_controller(plugin, main_file, robot, warnings);
      continue;
    }
    const std::string name = plugin.element->attribute("name");
    const std::string file = plugin.element->attribute("filename");
    warnings.list(" <plugin> not run: ",
                  fmt::format("'{}'", printable_text(file.empty() ? name : file, 200)));
    plugin.element->pass_over_all();
  }
}

}  // namespace crossgait
