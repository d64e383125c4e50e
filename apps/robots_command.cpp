// crossgait robots: the bundled robots, or one robot in detail.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crossgait/apps/command.h"
#include "crossgait/parity/schema.h"
#include "crossgait/parity/table.h"
#include "crossgait/physics/data_path.h"
#include "crossgait/physics/robot.h"

namespace crossgait::apps {
namespace {

using nlohmann::ordered_json;

struct RobotsCommand {
  std::string robot;
  JsonOption json;
};

ordered_json summary(const RobotDescription& robot) {
  return {{"name", robot.name},
          {"file", robot.source},
          {"mass_kg", robot.total_mass()},
          {"bodies", robot.bodies.size()},
          {"joints", robot.joint_count()},
          {"servos", robot.actuated_joints().size()},
          {"loops", robot.loops.size()},
          {"home_height_m", robot.home_height}};
}

void list_robots(const JsonOption& json) {
  Table table({"robot", "mass, kg", "bodies", "joints", "servos", "loops", "home height, m"});
  ordered_json robots = ordered_json::array();
  for (const std::string& robot_name : robot_names()) {
    const RobotDescription robot = load_robot(find_robot(robot_name));
    table.add_row({robot_name, fmt::format("{:.4f}", robot.total_mass()), std::to_string(robot.bodies.size()),
                   std::to_string(robot.joint_count()), std::to_string(robot.actuated_joints().size()),
                   std::to_string(robot.loops.size()), fmt::format("{:.4f}", robot.home_height)});
    robots.push_back(summary(robot));
  }
  json.emit(table.str(), with_schema("robots", {{"robots", std::move(robots)}}));
}

void show(const RobotsCommand& options) {
  const RobotDescription robot = load_robot(find_robot(options.robot));
  ordered_json result = summary(robot);
  result["body_list"] = ordered_json::array();
  Table table({robot.name, "parent", "mass, kg", "joint", "axis", "servo kp", "armature", "damping"});
  for (std::size_t b = 0; b < robot.bodies.size(); ++b) {
    const Body& body = robot.bodies[b];
    const bool base = b == 0;
    const Joint& joint = body.joint;
    const std::string parent = base ? "" : robot.bodies[static_cast<std::size_t>(body.parent)].name;
    const auto text = [base](double value) { return base ? std::string() : fmt::format("{:.3g}", value); };
    table.add_row(
        {body.name, parent, fmt::format("{:.5f}", body.inertia.mass), base ? "free" : joint.name,
         base ? "" : fmt::format("{:.3g} {:.3g} {:.3g}", joint.axis.x(), joint.axis.y(), joint.axis.z()),
         joint.actuated ? text(joint.kp) : "", text(joint.armature), text(joint.damping)});
    ordered_json entry{{"name", body.name}, {"parent", parent}, {"mass_kg", body.inertia.mass}};
    if (!base) {
      entry["joint"] = {{"name", joint.name},       {"lower_rad", joint.lower},
                        {"upper_rad", joint.upper}, {"actuated", joint.actuated},
                        {"kp", joint.kp},           {"kd", joint.kd},
                        {"damping", joint.damping}, {"armature", joint.armature}};
    }
    result["body_list"].push_back(std::move(entry));
  }
  const std::string total =
      fmt::format("\n{:.4f} kg in all, {}, base {:.4f} m above ground at home; from {}\n", robot.total_mass(),
                  counted(robot.loops.size(), "loop"), robot.home_height, robot.source);
  options.json.emit(table.str() + total, with_schema("robots", result),
                    options.json.provenance(of_robot(options.robot)));
}

}  // namespace

void add_robots_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("robots", "List the bundled robots, or show one");
  command->footer(
      "\nExamples:\n  crossgait robots\n  crossgait robots scara_quadruped\n  crossgait robots my.urdf");
  auto options = std::make_shared<RobotsCommand>();
  command->add_option("robot,--robot", options->robot,
                      "A bundled robot's name or a .yaml or .urdf file to show");
  options->json.add_to(*command);
  on_run(*command, [options] { options->robot.empty() ? list_robots(options->json) : show(*options); });
}

}  // namespace crossgait::apps
