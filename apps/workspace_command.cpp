// crossgait workspace: what one leg reaches, and whether a gait stays inside.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/leg_option.h"
#include "apps/page_option.h"
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
constexpr int kShades = 201;                     // grid points along the longer side of a chart
constexpr int kPathPoints = 400;

struct WorkspaceCommand {
  std::string robot = "scara_quadruped", gait = "trot";
  LegOption leg;
  std::vector<std::string> settings;
  PageOption page;
  JsonOption json;
};

struct Report {
  std::shared_ptr<const RobotDescription> robot;
  std::string gait;
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
  const auto robot = std::make_shared<const RobotDescription>(load_robot(find_robot(options.robot)));
  const LegArray<LegKinematics> legs = make_leg_kinematics(*robot);
  const LegKinematics& leg = legs[which];
  const LegBranch branch = options.leg.branch(leg);
  const GaitScale scale = gait_scale(*robot);
  const Gait gait = scaled(find_gait(options.gait), scale);
  const GaitChoice choice = choose_gait(options.gait, options.settings, {}, scale);
  const GaitParameters& parameters = choice.parameters;
  print_notes(parameter_notes(parameters, gait.preferred, scaled(AdaptationRanges(), scale)));

  Report report{
      .robot = robot, .gait = options.gait, .choice = choice, .which = which, .leg = leg, .branch = branch};
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
  Table places({fmt::format("{} of {}, {}, mm", name(r.which), r.robot->name, branch_text(r.leg, r.branch)),
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
  if (r.leg.kind() == LegKind::kClosedChain) {
    add_margin("to a dead point of the bars (parallel)", at.parallel, r.smallest_in_cycle.parallel,
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
  return {{"robot", r.robot->name},
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

// Smallest margins in the plane through the standing foot that `axis` (0 x, 1 y) and z span.
Chart::Shades shades(const Report& r, std::size_t axis) {
  const auto a = static_cast<Eigen::Index>(axis), across = 1 - a;
  TargetBox plane = r.reach;
  plane.min[across] = plane.max[across] = r.standing[across];
  const Vector3 size = plane.max - plane.min;
  const double spacing = std::max(size[a], size.z()) / (kShades - 1);
  const auto count = [spacing](double length) { return 2 + static_cast<int>(length / spacing); };
  std::array<int, 3> grid{2, 2, count(size.z())};
  grid[axis] = count(size[a]);
  const WorkspaceMap map = sample_workspace(r.leg, r.branch, plane, grid);

  Chart::Shades shades{.label = "smallest margin, deg",
                       .min = {kMillimetres * plane.min[a], kMillimetres * plane.min.z()},
                       .max = {kMillimetres * plane.max[a], kMillimetres * plane.max.z()},
                       .count = {static_cast<std::size_t>(grid[axis]), static_cast<std::size_t>(grid[2])},
                       .values = {}};
  for (int iz = 0; iz < grid[2]; ++iz) {
    for (int i = 0; i < grid[axis]; ++i) {
      const WorkspaceSample& sample = axis == 0 ? map.at(i, 0, iz) : map.at(0, i, iz);
      const LegMargins& m = sample.margins;
      std::optional<double> shade;
      if (sample.status == IkStatus::kOk)
        shade = kDegreesPerRadian * std::min({m.joint_limit, m.serial, m.parallel});
      shades.values.push_back(shade);
    }
  }
  return shades;
}

Chart slice(const Report& r, std::size_t axis) {
  const auto flat = [axis](const Vector3& p) -> Chart::Point {
    return {kMillimetres * p[static_cast<Eigen::Index>(axis)], kMillimetres * p.z()};
  };
  Chart chart{.title = fmt::format("{}-z plane at {} = {:.1f} mm", "xy"[axis], "xy"[1 - axis],
                                   kMillimetres * r.standing[1 - static_cast<Eigen::Index>(axis)]),
              .x_label = axis == 0 ? "x forward, mm" : "y to the left, mm",
              .y_label = "z up from the shoulders, mm",
              .equal_scales = true};
  chart.shades = shades(r, axis);
  chart.boxes.push_back({"safe box", 3, false, {{flat(r.safe.min), flat(r.safe.max)}}});
  Chart::Series path{"path, " + r.gait, 1, Chart::Series::Style::kPath, {}};
  for (const Vector3& p : r.path) path.points.push_back(flat(p));
  chart.series.push_back(std::move(path));
  chart.series.push_back({"standing foot", 0, Chart::Series::Style::kDots, {flat(r.standing)}});
  return chart;
}

ReportPage page_of(const Report& r) {
  ReportPage page;
  page.title =
      fmt::format("Workspace of {} of {}, {}", name(r.which), r.robot->name, branch_text(r.leg, r.branch));
  page.charts.push_back({"Planes through the standing foot", {slice(r, 0), slice(r, 1)}});
  page.texts.push_back(describe(r));
  return page;
}

void run(const WorkspaceCommand& options) {
  options.page.check();
  const Report report = look(options);
  const Provenance provenance = options.json.provenance(of_gait(report.robot, report.choice));
  if (options.page.asked()) options.page.write(page_of(report), provenance);
  options.json.emit(describe(report), with_schema("workspace", to_json(report)), provenance);
}

}  // namespace

void add_workspace_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command =
      program.add_subcommand("workspace", "What one leg reaches, and whether a gait stays inside");
  command->footer(
      "\nThe page shows the planes through the standing foot. Shades are the distance of the posture\n"
      "to the nearest joint limit or singularity; nothing is shaded out of reach. Every target in the safe "
      "box\n"
      "keeps the margins of the table.\n"
      "\nExamples:\n"
      "  crossgait workspace --report workspace.html\n"
      "  crossgait workspace --leg RR --gait walk --set step_length=.1 --set body_height=.055");
  auto options = std::make_shared<WorkspaceCommand>();
  options->leg.add_to(*command);
  command->add_option("--gait", options->gait, "The gait to check")->capture_default_str();
  command->add_option("--set", options->settings, "Change a gait parameter; may be repeated")
      ->type_name("NAME=VALUE");
  options->page.add_to(*command, "Write a page that shows what is within reach, as one HTML file");
  add_robot_option(*command, options->robot);
  options->json.add_to(*command, invocation);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
