// crossgait ik: joint angles of one leg for one foot target.
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/leg_option.h"
#include "physics/core/error.h"
#include "physics/core/math.h"
#include "physics/core/schema.h"
#include "physics/core/table.h"
#include "physics/robot_files/data_path.h"

namespace crossgait::apps {
namespace {

struct IkCommand {
  std::string robot = "scara_quadruped";
  LegOption leg;
  std::string target;
  JsonOption json;
};

std::string spaced(std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

void run(const IkCommand& options) {
  const Leg which = options.leg.which();
  const auto xyz = parse_numbers(options.target, 3, "--target", "X,Y,Z in m, z up from the hip");

  const RobotDescription robot = load_robot(find_robot(options.robot));
  const LegKinematics kinematics = make_leg_kinematics(robot, which);
  const LegBranch branch = options.leg.branch(kinematics);
  const auto [status, posture] = kinematics.inverse({xyz[0], xyz[1], xyz[2]}, branch);
  const Vector3 foot = kinematics.forward(posture.servos, branch).foot;
  const LegMargins margins = kinematics.margins(posture);

  Table table({fmt::format("{} of {}, {}", options.leg.leg, robot.name, branch_text(kinematics, branch)),
               "rad", "deg"});
  const auto angle = [&table](const std::string& label, double value) {
    table.add_row({label, fmt::format("{:.9f}", value), fmt::format("{:.4f}", value * kDegreesPerRadian)});
  };
  nlohmann::ordered_json joints;
  const LegRoles roles = (*robot.legs)[which].roles();
  for (std::size_t i = 0; i < roles.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const Eigen::Index servos = posture.servos.size();
    const double value = roles[i].actuated ? posture.servos[k] : posture.passive[k - servos];
    angle(std::string(roles[i].name) + (roles[i].actuated ? "" : " (passive)"), value);
    joints[std::string(roles[i].name)] = value;
  }
  const bool five_bar = kinematics.kind() == LegKind::kFiveBar;
  angle("margin to joint limits", margins.joint_limit);
  angle(five_bar ? "margin to straight or folded elbows" : "margin to a straight or folded knee",
        margins.serial);
  if (five_bar) angle("margin to parallel lower links", margins.parallel);
  if (kinematics.kind() == LegKind::kClosedChain)
    angle("margin to a dead point of the bars", margins.parallel);
  std::string text = fmt::format("{}; status: {}; foot at {:.6f}, {:.6f}, {:.6f} m\n",
                                 spaced(name(kinematics.kind())), name(status), foot.x(), foot.y(), foot.z());
  if (status != IkStatus::kOk && xyz[2] > 0) {
    text += "hint: z points up, so the target lies above the hip; a foot below it has negative z\n";
  }
  options.json.emit(table.str() + text,
                    with_schema("ik", {{"status", name(status)},
                                       {"kind", name(kinematics.kind())},
                                       {"branch", branch_text(kinematics, branch)},
                                       {"joints_rad", joints},
                                       {"foot_m", {foot.x(), foot.y(), foot.z()}},
                                       {"margins_rad",
                                        {{"joint_limit", margins.joint_limit},
                                         {"serial", margins.serial},
                                         {"parallel", margins.parallel}}}}),
                    options.json.provenance(of_robot(robot)));
}

}  // namespace

void add_ik_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command = program.add_subcommand("ik", "Joint angles of one leg that put its foot on a target");
  command->footer(
      "\nThe leg frame's origin is midway between the shoulders of a five-bar, on the hip axis of a serial "
      "leg,\n"
      "in the plane of the foot at zero tilt: x forward, y left, z up. A foot below has negative z.\n"
      "A target out of reach is moved to the edge of the workspace, and the status says so.\n"
      "\nExample:  crossgait ik --target 0.01,0.02,-0.07 --leg FR");
  auto options = std::make_shared<IkCommand>();
  command->add_option("--target", options->target, "Foot centre in the leg frame, m")
      ->type_name("X,Y,Z")
      ->required();
  options->leg.add_to(*command);
  add_robot_option(*command, options->robot);
  options->json.add_to(*command, invocation);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
