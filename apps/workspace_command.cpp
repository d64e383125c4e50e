// crossgait workspace: what one leg reaches, and whether a gait stays inside.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/leg_option.h"
#include "apps/plotting.h"
#include "gait/cycle_check.h"
#include "ik/workspace.h"
#include "motion/gait_source.h"
#include "physics/core/error.h"
#include "physics/core/math.h"
#include "physics/core/schema.h"
#include "physics/core/table.h"
#include "physics/robot_files/data_path.h"

namespace crossgait::apps {
namespace {

using nlohmann::ordered_json;

constexpr double kMillimetres = 1e3;
constexpr std::array<int, 3> kGrid{61, 61, 61};  // of the reachable fraction
constexpr int kShades = 201;                     // grid points along the longer side of a picture
constexpr int kPathPoints = 400;

struct WorkspaceCommand {
  std::string robot = "scara_quadruped", gait = "trot";
  LegOption leg;
  std::vector<std::string> settings;
  std::string out;
  JsonOption json;
};

struct Report {
  std::string robot, gait;
  GaitChoice choice;
  Leg which;
  LegKinematics leg;
  LegBranch branch;
  TargetBox reach = {}, safe = {};
  double reachable_fraction = 0;
  Vector3 standing = Vector3::Zero();  // foot in the middle of its stance
  WorkspaceSample standing_sample = {};
  std::vector<Vector3> path = {};     // one cycle in full stride
  LegMargins smallest_in_cycle = {};  // of the reachable targets
  CycleCheck cycle = {};              // of all legs
};

std::vector<Vector3> foot_path(const Gait& gait, const GaitParameters& parameters, Leg leg) {
  const FootStride stride{{parameters.step_length, 0}, 1, parameters.swing};
  std::vector<Vector3> path;
  for (int i = 0; i <= kPathPoints; ++i) {
    const double clock = static_cast<double>(i % kPathPoints) / kPathPoints;
    path.push_back(
        foot_position(parameters, leg, leg_phase(clock, gait.offset[leg], parameters.duty_factor), stride));
  }
  return path;
}

LegMargins smallest_margins(const LegKinematics& leg, const std::vector<Vector3>& path, LegBranch branch) {
  LegMargins smallest{HUGE_VAL, HUGE_VAL, HUGE_VAL};
  for (const Vector3& target : path) {
    const WorkspaceSample sample = sample_target(leg, target, branch);
    if (sample.status != IkStatus::kOk) return {};
    smallest.joint_limit = std::min(smallest.joint_limit, sample.margins.joint_limit);
    smallest.serial = std::min(smallest.serial, sample.margins.serial);
    smallest.parallel = std::min(smallest.parallel, sample.margins.parallel);
  }
  return smallest;
}

Report look(const WorkspaceCommand& options) {
  const Leg which = options.leg.which();
  const RobotDescription robot = load_robot(find_robot(options.robot));
  const LegArray<LegKinematics> legs = make_leg_kinematics(robot);
  const LegKinematics& leg = legs[which];
  const LegBranch branch = options.leg.branch(leg);
  const GaitScale scale = gait_scale(robot);
  const Gait gait = scaled(find_gait(options.gait), scale);
  const GaitChoice choice = choose_gait(options.gait, options.settings, {}, scale);
  const GaitParameters& parameters = choice.parameters;
  print_notes(outside_ranges(parameters, gait.preferred, scaled(AdaptationRanges(), scale)));

  Report report{.robot = robot.name,
                .gait = options.gait,
                .choice = choice,
                .which = which,
                .leg = leg,
                .branch = branch};
  report.reach = reach_bounds(leg);
  report.reachable_fraction = sample_workspace(leg, branch, report.reach, kGrid).reachable_fraction();
  report.standing = foot_position(parameters, which, {}, {{0, 0}, 0, parameters.swing});
  report.standing_sample = sample_target(leg, report.standing, branch);
  report.safe = safe_box(leg, report.standing, branch);
  report.path = foot_path(gait, parameters, which);
  report.smallest_in_cycle = smallest_margins(leg, report.path, branch);
  report.cycle = check_cycle(gait, parameters, [&](Leg any, const Vector3& target) {
    return legs[any].inverse(target, branch).status == IkStatus::kOk;
  });
  return report;
}

TargetBox bounds(const std::vector<Vector3>& points) {
  TargetBox box{points.front(), points.front()};
  for (const Vector3& p : points) {
    box.min = box.min.cwiseMin(p);
    box.max = box.max.cwiseMax(p);
  }
  return box;
}

std::string verdict(const Report& report) {
  const CycleCheck& cycle = report.cycle;
  if (cycle.ok()) {
    return fmt::format("{}: all {} targets of a cycle of the four legs are within reach\n", report.gait,
                       cycle.targets);
  }
  std::string blame;
  for (const std::string_view parameter : cycle.offending) {
    blame += fmt::format("{}{}", blame.empty() ? "" : ", ", parameter);
  }
  const CycleCheck::Failure& first = *cycle.first;
  const Vector3 mm = kMillimetres * first.target;
  return fmt::format(
      "{}: {} of {} targets of a cycle of the four legs are out of reach, first of {} at phase {:.3f}: "
      "{:.1f}, {:.1f}, {:.1f} mm; to blame: {}\n",
      report.gait, cycle.unreachable, cycle.targets, name(first.leg), first.phase, mm.x(), mm.y(), mm.z(),
      blame.empty() ? "the leg or the working mode, not a parameter" : blame);
}

std::string describe(const Report& r) {
  Table places({fmt::format("{} of {}, {}, mm", name(r.which), r.robot, branch_text(r.leg, r.branch)),
                "x from", "to", "y from", "to", "z from", "to"});
  const auto add_box = [&places](const std::string& label, const TargetBox& box) {
    std::vector<std::string> cells{label};
    for (int axis = 0; axis < 3; ++axis) {
      for (const double end : {box.min[axis], box.max[axis]})
        cells.push_back(fmt::format("{:.1f}", kMillimetres * end));
    }
    places.add_row(std::move(cells));
  };
  add_box("reach of the links", r.reach);
  add_box("safe box around the standing foot", r.safe);
  add_box("foot path of " + r.gait, bounds(r.path));
  add_box("standing foot", {r.standing, r.standing});

  Table margins({"margins, deg", "standing", "least in a cycle", "safe from"});
  const RequiredMargins required;
  const bool stands = r.standing_sample.status == IkStatus::kOk;
  const auto add_margin = [&](const char* label, double standing, double cycle, double wanted) {
    margins.add_row({label, stands ? fmt::format("{:.2f}", kDegreesPerRadian * standing) : "out of reach",
                     fmt::format("{:.2f}", kDegreesPerRadian * cycle),
                     fmt::format("{:.2f}", kDegreesPerRadian * wanted)});
  };
  const LegMargins& at = r.standing_sample.margins;
  add_margin("to joint limits", at.joint_limit, r.smallest_in_cycle.joint_limit, required.joint_limit);
  const bool five_bar = r.leg.kind() == LegKind::kFiveBar;
  add_margin(five_bar ? "to straight or folded elbows (serial)" : "to a straight or folded knee (serial)",
             at.serial, r.smallest_in_cycle.serial, required.serial);
  if (five_bar) {
    add_margin("to parallel lower links (parallel)", at.parallel, r.smallest_in_cycle.parallel,
               required.parallel);
  }
  return places.str() + "\n" + margins.str() +
         fmt::format("\nreachable: {:.1f} % of the reach of the links\n", 100 * r.reachable_fraction) +
         verdict(r);
}

ordered_json numbers(const Vector3& v) { return {v.x(), v.y(), v.z()}; }
ordered_json to_json(const TargetBox& box) { return {{"min", numbers(box.min)}, {"max", numbers(box.max)}}; }
ordered_json to_json(const LegMargins& m) {
  return {{"joint_limit", m.joint_limit}, {"serial", m.serial}, {"parallel", m.parallel}};
}

ordered_json to_json(const Report& r) {
  ordered_json cycle{{"targets", r.cycle.targets},
                     {"unreachable", r.cycle.unreachable},
                     {"first", nullptr},
                     {"offending", r.cycle.offending}};
  if (r.cycle.first) {
    cycle["first"] = {{"leg", name(r.cycle.first->leg)},
                      {"phase", r.cycle.first->phase},
                      {"target_m", numbers(r.cycle.first->target)}};
  }
  const bool stands = r.standing_sample.status == IkStatus::kOk;
  return {{"robot", r.robot},
          {"leg", name(r.which)},
          {"kind", name(r.leg.kind())},
          {"branch", branch_text(r.leg, r.branch)},
          {"gait", r.gait},
          {"reach_m", to_json(r.reach)},
          {"reachable_fraction", r.reachable_fraction},
          {"safe_box_m", to_json(r.safe)},
          {"foot_path_m", to_json(bounds(r.path))},
          {"standing_foot_m", numbers(r.standing)},
          {"standing_status", name(r.standing_sample.status)},
          {"standing_margins_rad", stands ? to_json(r.standing_sample.margins) : ordered_json()},
          {"cycle_margins_rad", to_json(r.smallest_in_cycle)},
          {"cycle", std::move(cycle)}};
}

// The plane through the standing foot that `axis` (0 x, 1 y) and z span.
Panel slice(const Report& r, int axis) {
  const auto flat = [axis](const Vector3& p) -> PlotPoint {
    return {kMillimetres * p[axis], kMillimetres * p.z()};
  };
  const int across = 1 - axis;
  TargetBox plane = r.reach;
  plane.min[across] = plane.max[across] = r.standing[across];
  const Vector3 size = plane.max - plane.min;
  const double spacing = std::max(size[axis], size.z()) / (kShades - 1);
  const auto count = [spacing](double length) { return 2 + static_cast<int>(length / spacing); };
  std::array<int, 3> grid{2, 2, count(size.z())};
  grid[static_cast<std::size_t>(axis)] = count(size[axis]);
  const WorkspaceMap map = sample_workspace(r.leg, r.branch, plane, grid);

  Panel panel;
  panel.title = fmt::format("{}-z plane at {} = {:.1f} mm", "xy"[axis], "xy"[across],
                            kMillimetres * r.standing[across]);
  panel.x_label = axis == 0 ? "x forward, mm" : "y to the left, mm";
  panel.y_label = "z up from the shoulders, mm";
  panel.equal_scales = true;
  panel.shades = ShadeMap{"smallest margin, deg",
                          flat(plane.min),
                          flat(plane.max),
                          {grid[static_cast<std::size_t>(axis)], grid[2]},
                          {}};
  for (int iz = 0; iz < grid[2]; ++iz) {
    for (int i = 0; i < grid[static_cast<std::size_t>(axis)]; ++i) {
      const WorkspaceSample& sample = axis == 0 ? map.at(i, 0, iz) : map.at(0, i, iz);
      const LegMargins& m = sample.margins;
      std::optional<double> shade;
      if (sample.status == IkStatus::kOk)
        shade = kDegreesPerRadian * std::min({m.joint_limit, m.serial, m.parallel});
      panel.shades->values.push_back(shade);
    }
  }
  panel.bars.push_back({"safe box", {{flat(r.safe.min), flat(r.safe.max)}}, 6, false});
  Series path{"path, " + r.gait, {}, 1, Series::Style::kLine};
  for (const Vector3& p : r.path) path.points.push_back(flat(p));
  panel.series.push_back(std::move(path));
  panel.series.push_back({"standing foot", {flat(r.standing)}, 6, Series::Style::kPoints, 3});
  return panel;
}

void run(const WorkspaceCommand& options) {
  if (!options.out.empty()) check_plot_path(options.out, "--out");
  const Report report = look(options);
  if (!options.out.empty()) {
    Figure figure;
    figure.title = fmt::format("Workspace of {} of {}, {}", name(report.which), report.robot,
                               branch_text(report.leg, report.branch));
    figure.rows.push_back({{slice(report, 0), slice(report, 1)}, 380, 2});
    draw(figure, options.out);
  }
  options.json.emit(describe(report), with_schema("workspace", to_json(report)),
                    options.json.provenance(of_gait(options.robot, report.choice)));
}

}  // namespace

void add_workspace_command(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("workspace", "What one leg reaches, and whether a gait stays inside");
  command->footer(
      "\nThe picture shows the planes through the standing foot. Shades are the distance of the posture\n"
      "to the nearest joint limit or singularity; white is out of reach. Every target in the safe box\n"
      "keeps the margins of the table.\n"
      "\nExamples:\n"
      "  crossgait workspace --out workspace.png\n"
      "  crossgait workspace --leg RR --gait walk --set step_length=.1 --set body_height=.055");
  auto options = std::make_shared<WorkspaceCommand>();
  options->leg.add_to(*command);
  command->add_option("--gait", options->gait, "The gait to check")->capture_default_str();
  command->add_option("--set", options->settings, "Change a gait parameter; may be repeated")
      ->type_name("NAME=VALUE");
  add_output_option(*command, "--out", options->out, "Draw a picture")->type_name("FILE.svg|FILE.png");
  add_robot_option(*command, options->robot);
  options->json.add_to(*command);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
