// crossgait ik: joint angles of one leg for one foot target.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crossgait/apps/command.h"
#include "crossgait/ik/five_bar_leg.h"
#include "crossgait/parity/schema.h"
#include "crossgait/parity/table.h"
#include "crossgait/physics/data_path.h"
#include "crossgait/physics/error.h"
#include "crossgait/physics/math.h"

namespace crossgait::apps {
namespace {

struct IkCommand {
  std::string robot = "scara_quadruped";
  std::string leg = "FL";
  std::string target;
  int mode = static_cast<int>(kDefaultMode);
  JsonOption json;
};

void run(const IkCommand& options) {
  const auto leg = leg_from_name(options.leg);
  if (!leg) throw ConfigError("command line", "--leg", "FL, FR, RL or RR", "\"" + options.leg + "\"");
  const auto mode = working_mode(options.mode);
  if (!mode)
    throw ConfigError("command line", "--mode", "a working mode from 1 to 4", std::to_string(options.mode));
  const auto xyz = parse_numbers(options.target, 3, "--target", "X,Y,Z in m, z up from the shoulders");

  const RobotDescription robot = load_robot(find_robot(options.robot));
  const FiveBarGeometry geometry = five_bar_geometry(robot, *leg);
  const LegSolution solution = solve_leg(geometry, {xyz[0], xyz[1], xyz[2]}, *mode);
  const LegAngles& q = solution.angles;
  const Vector3 foot = forward_leg(geometry, q.tilt, q.shoulder_left, q.shoulder_right, *mode).foot;
  const LegMargins margins = leg_margins(geometry, q);

  Table table({fmt::format("{} of {}, mode {}", options.leg, robot.name, options.mode), "rad", "deg"});
  const auto angle = [&table](const char* label, double value) {
    table.add_row({label, fmt::format("{:.9f}", value), fmt::format("{:.4f}", value * kDegreesPerRadian)});
  };
  angle("tilt", q.tilt);
  angle("shoulder_left", q.shoulder_left);
  angle("shoulder_right", q.shoulder_right);
  angle("elbow_left (passive)", q.elbow_left);
  angle("elbow_right (passive)", q.elbow_right);
  angle("margin to joint limits", margins.joint_limit);
  angle("margin to straight or folded elbows", margins.serial);
  angle("margin to parallel lower links", margins.parallel);
  std::string text = fmt::format("status: {}; foot at {:.6f}, {:.6f}, {:.6f} m\n", name(solution.status),
                                 foot.x(), foot.y(), foot.z());
  if (solution.status != IkStatus::kOk && xyz[2] > 0) {
    text += "hint: z points up, so the target lies above the shoulders; a foot below them has negative z\n";
  }
  options.json.emit(table.str() + text,
                    with_schema("ik", {{"status", name(solution.status)},
                                       {"tilt", q.tilt},
                                       {"shoulder_left", q.shoulder_left},
                                       {"shoulder_right", q.shoulder_right},
                                       {"elbow_left", q.elbow_left},
                                       {"elbow_right", q.elbow_right},
                                       {"foot_m", {foot.x(), foot.y(), foot.z()}},
                                       {"margins_rad",
                                        {{"joint_limit", margins.joint_limit},
                                         {"serial", margins.serial},
                                         {"parallel", margins.parallel}}}}),
                    options.json.provenance(of_robot(options.robot)));
}

}  // namespace

void add_ik_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("ik", "Joint angles of one leg that put its foot on a target");
  command->footer(
      "\nThe leg frame's origin is midway between the shoulders at zero tilt: x forward, y left, z up.\n"
      "A foot below the shoulders has negative z.\n"
      "Working modes: 1 knees inward, 2 knees outward, 3 both forward, 4 both backward. A target out of "
      "reach\n"
      "is moved to the edge of the workspace, and the status says so.\n"
      "\nExample:  crossgait ik --target 0.01,0.02,-0.07 --leg FR");
  auto options = std::make_shared<IkCommand>();
  command->add_option("--target", options->target, "Foot centre in the leg frame, m")
      ->type_name("X,Y,Z")
      ->required();
  command->add_option("--mode", options->mode, "Working mode, 1 to 4")->capture_default_str();
  command->add_option("--leg", options->leg, "FL, FR, RL or RR")->capture_default_str();
  add_robot_option(*command, options->robot);
  options->json.add_to(*command);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
