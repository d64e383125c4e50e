// crossgait robots: the bundled robots, or one robot in detail.
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "backends/registry.h"
#include "ik/leg_kinematics.h"
#include "physics/core/error.h"
#include "physics/core/folder.h"
#include "physics/core/schema.h"
#include "physics/core/table.h"
#include "physics/robot_files/data_path.h"
#include "physics/robot_files/installed_robots.h"
#include "physics/robot_files/robot_formats.h"
#include "physics/robot_files/robot_report.h"
#include "study/robot_difference.h"
#include "study/robot_findings.h"
#include "study/robot_lint.h"
#include "study/robot_quantities.h"
#include "study/trial_walk.h"

namespace crossgait::apps {
namespace {

using nlohmann::ordered_json;

struct RobotsCommand {
  std::vector<std::string> robots;
  std::string against, format, baseline, fail_on = "error";
  bool yaml = false, check = false, list = false;
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

void list_robots(const JsonOption& json, bool installed) {
  Table table({"robot", "mass, kg", "bodies", "joints", "servos", "loops", "home height, m"});
  ordered_json robots = ordered_json::array();
  for (const std::string& robot_name : robot_names()) {
    const RobotDescription robot = load_robot(find_robot(robot_name));
    table.add_row({robot_name, fmt::format("{:.4f}", robot.total_mass()), std::to_string(robot.bodies.size()),
                   std::to_string(robot.joint_count()), std::to_string(robot.actuated_joints().size()),
                   std::to_string(robot.loops.size()), fmt::format("{:.4f}", robot.home_height)});
    robots.push_back(summary(robot));
  }
  ordered_json result{{"robots", std::move(robots)}};
  std::string text = table.str();
  if (installed) {
    Table found({"robot", "from", "file"});
    result["installed"] = ordered_json::array();
    for (const InstalledRobot& robot : installed_robots()) {
      found.add_row({robot.name, robot.from, robot.file});
      result["installed"].push_back({{"name", robot.name}, {"from", robot.from}, {"file", robot.file}});
    }
    text += "\nInstalled, by name for --robot (docs/robots.md):\n" + found.str();
  }
  json.emit(text, with_schema("robots", result));
}

ordered_json body_list(const RobotDescription& robot, Table& table) {
  ordered_json list = ordered_json::array();
  for (std::size_t b = 0; b < robot.bodies.size(); ++b) {
    const Body& body = robot.bodies[b];
    const bool base = b == 0;
    const Joint& joint = body.joint;
    const std::string parent = base ? "" : robot.bodies[static_cast<std::size_t>(body.parent)].name;
    const auto text = [base](double value) { return base ? std::string() : fmt::format("{:.3g}", value); };
    table.add_row(
        {body.name, parent, fmt::format("{:.5f}", body.inertia.mass), base ? "free" : joint.name,
         base ? "" : fmt::format("{:.3g} {:.3g} {:.3g}", joint.axis.x(), joint.axis.y(), joint.axis.z()),
         joint.actuated ? text(joint.kp) : "", text(joint.armature), text(joint.damping),
         text(joint.friction)});
    ordered_json entry{{"name", body.name},
                       {"parent", parent},
                       {"mass_kg", body.inertia.mass},
                       {"visuals", body.visuals.size()}};
    if (!base) {
      entry["joint"] = {{"name", joint.name},
                        {"lower_rad", joint.lower},
                        {"upper_rad", joint.upper},
                        {"actuated", joint.actuated},
                        {"kp", joint.kp},
                        {"kd", joint.kd},
                        {"damping", joint.damping},
                        {"friction", joint.friction},
                        {"armature", joint.armature},
                        {"effort_limit", joint.effort_limit}};
    }
    list.push_back(std::move(entry));
  }
  return list;
}

/// Links between the joints of a leg and its foot, m.
std::vector<double> lengths_of(const RobotDescription& robot, Leg leg, const LegKinematics& kinematics) {
  if (const auto* five_bar = kinematics.as<FiveBarGeometry>())
    return {five_bar->a.upper, five_bar->a.lower, five_bar->b.upper, five_bar->b.lower};
  const LegLengths lengths = leg_lengths(robot, leg);
  return {lengths.thigh, lengths.shin};
}

ordered_json leg_list(const RobotDescription& robot, Table& table) {
  ordered_json legs;
  const LegArray<LegKinematics> kinematics = make_leg_kinematics(robot);
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    const std::vector<double> lengths = lengths_of(robot, leg, kinematics[leg]);
    std::vector<std::string> joints, texts;
    for (const int joint : model.joints()) joints.push_back(robot.joint(joint).name);
    for (const double length : lengths) texts.push_back(fmt::format("{:.4g}", length));
    const std::string& link = robot.bodies[static_cast<std::size_t>(model.foot_body)].name;
    const std::string_view kind = name(kinematics[leg].kind());
    table.add_row({std::string(name(leg)), std::string(kind), fmt::format("{}", fmt::join(joints, " ")),
                   fmt::format("{}, radius {:.4g} m", link, model.foot_radius),
                   fmt::format("{}", fmt::join(texts, " "))});
    legs[std::string(name(leg))] = {{"kind", kind},
                                    {"joints", joints},
                                    {"foot",
                                     {{"link", link},
                                      {"point_m", {model.p_BF.x(), model.p_BF.y(), model.p_BF.z()}},
                                      {"radius_m", model.foot_radius}}},
                                    {"lengths_m", lengths}};
  }
  return legs;
}

ordered_json home_of(const RobotDescription& robot) {
  ordered_json home;
  for (int i = 0; i < robot.joint_count(); ++i) home[robot.joint(i).name] = robot.home[i];
  return home;
}

LoadedRobot load(const RobotsCommand& options) {
  return load_robot_with_report(find_robot(options.robots.front()));
}

/// What was inferred and what is doubtful, as lines.
std::string remarks(const RobotReport& report, const std::vector<std::string>& warnings,
                    const std::vector<RobotFinding>& findings) {
  std::string text;
  if (!report.inferred.empty()) text += "\nInferred, and why (a robot.yaml overrides any of it):\n";
  for (const Inference& i : report.inferred)
    text += fmt::format("  {}: {}\n      {}\n", i.what, i.value, i.reason);
  for (const std::string& warning : warnings) text += fmt::format("\nwarning: {}", warning);
  if (!warnings.empty()) text += "\n";
  return findings.empty() ? text : text + "\nHeld against the robot's own size:\n" + describe(findings);
}

void show(const RobotsCommand& options) {
  const LoadedRobot loaded = load(options);
  const RobotDescription& robot = loaded.robot;
  if (options.yaml) {
    print_data(to_yaml(loaded, absolute_path(loaded.report.file).lexically_normal().string()));
    return;
  }
  const Joint& servo = robot.joint((*robot.legs)[Leg::FL].servos.front());
  const double h = robot.standing_height, time = std::sqrt(h / kGravity);
  ordered_json result = summary(robot);
  Table legs({"leg", "kind", "joints", "foot", "lengths, m"}),
      bodies(
          {robot.name, "parent", "mass, kg", "joint", "axis", "servo kp", "armature", "damping", "friction"});
  result["legs"] = leg_list(robot, legs);
  result["home_rad"] = home_of(robot);
  result["servo"] = {
      {"kp", servo.kp}, {"kd", servo.kd}, {"armature", servo.armature}, {"effort_limit", servo.effort_limit}};
  result["gait_scale"] = {
      {"standing_height_m", h}, {"time_s", time}, {"stance_offset_m", robot.stance_offset}};
  result["inferred"] = ordered_json::array();
  for (const Inference& i : loaded.report.inferred)
    result["inferred"].push_back({{"what", i.what}, {"value", i.value}, {"reason", i.reason}});
  const WorldSpec world = world_of(loaded);
  const std::vector<RobotQuantity> quantities = robot_quantities(loaded, world);
  const std::vector<std::string> warnings = robot_warnings(loaded, world);
  result["quantities"] = to_json(quantities);
  result["warnings"] = warnings;
  const std::vector<RobotFinding> findings = robot_findings(loaded);
  result["findings"] = to_json(all_findings(loaded, world));
  result["body_list"] = body_list(robot, bodies);
  const std::string total = fmt::format(
      "\n{:.4f} kg in all, {}, base {:.4f} m above ground at home; gaits scale with {:.4g} m and {:.3g} s; "
      "from "
      "{}\n",
      robot.total_mass(), counted(robot.loops.size(), "loop"), robot.home_height, h, time, robot.source);
  options.json.emit(bodies.str() + "\n" + legs.str() + total + "\n" + describe(quantities) +
                        remarks(loaded.report, warnings, findings),
                    with_schema("robots", result), options.json.provenance(of_robot(robot)));
}

/// Whether it walks with the servos of the rule where it does not with those of its file. Empty if that says
/// nothing of the gains.
std::string blame_gains(const RobotsCommand& options, const LoadedRobot& loaded, const Trial& trial) {
  if (trial.passed() || servo_source() == ServoSource::kRule) return "";
  const LoadedRobot by_rule = load_robot_with_report(find_robot(options.robots.front()), ServoSource::kRule);
  const Joint& file = loaded.robot.joint((*loaded.robot.legs)[Leg::FL].servos.back());
  const Joint& rule = by_rule.robot.joint((*by_rule.robot.legs)[Leg::FL].servos.back());
  if (file.kp == rule.kp && file.kd == rule.kd) return "";
  const Trial other = try_robot(std::make_shared<const RobotDescription>(by_rule.robot), available_engines());
  const std::string gains =
      fmt::format("kp {:.3g} N m/rad and kd {:.3g} N m s/rad of '{}', by rule {:.3g} and {:.3g}", file.kp,
                  file.kd, file.name, rule.kp, rule.kd);
  return other.passed()
             ? fmt::format(
                   "The gains are the cause: {}; with the rule's it walks well (--servos rule, or "
                   "`servo: rule` in a robot.yaml).",
                   gains)
             : fmt::format(
                   "The gains are not the cause, or not alone: {}; with the rule's something is wrong, "
                   "too (--servos rule).",
                   gains);
}

/// Walks it. @throws std::runtime_error if something is wrong
void check(const RobotsCommand& options) {
  const LoadedRobot loaded = load(options);
  Trial trial = try_robot(std::make_shared<const RobotDescription>(loaded.robot), available_engines());
  const std::vector<RobotFinding> findings = robot_findings(loaded);
  const bool is_real = findings.empty() || findings.front().severity != Severity::kError;
  if (!is_real) trial = without_advice(std::move(trial));
  // What no real machine has explains more than gains do.
  const std::string cause = is_real || trial.passed()
                                ? blame_gains(options, loaded, trial)
                                : fmt::format("First of all: {}.", describe(findings.front()));
  const WorldSpec world = world_of(loaded);
  const std::vector<std::string> warnings = robot_warnings(loaded, world);
  ordered_json result{{"name", loaded.robot.name}, {"file", loaded.robot.source}};
  result.update(to_json(trial));
  if (!cause.empty()) result["cause"] = cause;
  result["warnings"] = warnings;
  result["findings"] = to_json(all_findings(loaded, world));
  std::string text = describe(trial) + (cause.empty() ? "" : cause + "\n");
  for (const std::string& warning : warnings) text += fmt::format("warning: {}\n", warning);
  text += describe(findings);
  options.json.emit(text, with_schema("robots", result), options.json.provenance(of_robot(loaded.robot)));
  if (!trial.passed()) throw std::runtime_error("it does not walk as it should: see above");
}

/// Two descriptions of one robot.
void compare(const RobotsCommand& options) {
  const LoadedRobot a = load(options), b = load_robot_with_report(find_robot(options.against));
  const std::vector<std::string> engines = available_engines();
  const WalkGaps gaps = walk_gaps(try_robot(std::make_shared<const RobotDescription>(a.robot), engines),
                                  try_robot(std::make_shared<const RobotDescription>(b.robot), engines));
  const RobotDifference difference = robot_difference(a.robot, b.robot);
  ordered_json result{{"name", a.robot.name}, {"file", a.robot.source}, {"against", b.robot.source}};
  result.update(to_json(difference, gaps));
  options.json.emit(describe(difference, gaps), with_schema("robots", result),
                    options.json.provenance(of_robot(a.robot)));
}

/// Findings of many files, for programs. @throws RequirementMissed if there are new ones
void lint(const RobotsCommand& options) {
  static const std::map<std::string, LintFormat> kFormats{{"", LintFormat::kText},
                                                          {"text", LintFormat::kText},
                                                          {"json", LintFormat::kJson},
                                                          {"sarif", LintFormat::kSarif},
                                                          {"junit", LintFormat::kJunit}};
  LintReport report;
  if (!options.baseline.empty()) report.known = read_baseline(options.baseline);
  std::vector<std::string> files;
  for (const std::string& robot : options.robots) {
    files.push_back(find_robot(robot));
    // What is in a file is a finding; that there is none is a mistake of who asks.
    if (!std::filesystem::exists(files.back()))
      throw ConfigError(files.back(), "file", "a robot's file", "nothing there");
  }
  for (const std::string& file : files) report.robots.push_back(lint_robot(file, available_engines()));
  print_data(report.text(kFormats.at(options.format)));
  const std::size_t count =
      report.count_new(options.fail_on == "warning" ? Severity::kWarning : Severity::kError);
  if (count > 0)
    throw RequirementMissed(1,
                            fmt::format("{} of the findings fail it (--fail-on {})", count, options.fail_on));
}

void add_lint_options(CLI::App& command, RobotsCommand& options) {
  command
      .add_option(
          "--format", options.format,
          "With --check: the findings of every file named, for people or programs; exit code 1 if one of "
          "them fails it")
      ->check(CLI::IsMember({"text", "json", "sarif", "junit"}))
      ->needs("--check");
  command
      .add_option("--baseline", options.baseline,
                  "Findings that are known and fail nothing: what `--check --format json` printed before")
      ->type_name("FILE.json")
      ->needs("--check");
  command.add_option("--fail-on", options.fail_on, "From which severity on a new finding fails it")
      ->check(CLI::IsMember({"error", "warning"}))
      ->capture_default_str()
      ->needs("--check");
}

}  // namespace

void add_robots_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command = program.add_subcommand("robots", "List the bundled robots, or show one");
  command->footer(
      "\nOf a URDF, MJCF or SDF alone legs, frame, feet, home pose, servos and the scale of gaits are "
      "inferred, "
      "and "
      "every\n"
      "inference is printed with its reason. --yaml writes them as a robot.yaml, to be put beside the file "
      "and\n"
      "changed where a guess is wrong.\n"
      "\nExamples:\n  crossgait robots\n  crossgait robots scara_quadruped\n  crossgait robots my.urdf\n"
      "  crossgait robots my.urdf --yaml > robot.yaml\n"
      "  crossgait robots my.xml --check\n"
      "  crossgait robots my.urdf --against my.xml\n"
      "  crossgait robots *.urdf --check --format sarif > robots.sarif");
  auto options = std::make_shared<RobotsCommand>();
  command->add_option("robot,--robot", options->robots,
                      fmt::format("A bundled robot's name or a {} file to show; several with --check",
                                  robot_files_in_words()));
  command->add_flag("--list", options->list, "List those of installed packages, too, by name")
      ->excludes("--robot");
  command->add_flag("--check", options->check, "Walk it two seconds in every engine and say what is wrong")
      ->needs("--robot");
  command->add_flag("--yaml", options->yaml, "Print the whole robot.yaml instead")->needs("--robot");
  add_robot_file_options(*command);
  command
      ->add_option("--against", options->against,
                   "Hold it against another description of the same robot: what is unlike, and whether that "
                   "matters more than the engine")
      ->type_name("NAME|FILE")
      ->needs("--robot");
  add_lint_options(*command, *options);
  options->json.add_to(*command, invocation);
  on_run(*command, [options] {
    if (options->robots.empty()) return list_robots(options->json, options->list);
    const bool lints = !options->format.empty() || !options->baseline.empty();
    if (options->check && (lints || options->robots.size() > 1)) return lint(*options);
    if (options->robots.size() > 1)
      throw ConfigError("command line", "robot", "one robot, or --check", "several");
    if (!options->against.empty()) return compare(*options);
    options->check ? check(*options) : show(*options);
  });
}

}  // namespace crossgait::apps
