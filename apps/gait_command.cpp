// crossgait gait: the gaits, their parameters, and foot targets over time.
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/gait_page.h"
#include "apps/page_option.h"
#include "motion/gait_source.h"
#include "physics/core/atomic_file.h"
#include "physics/core/error.h"
#include "physics/core/schema.h"
#include "physics/core/table.h"
#include "physics/robot_files/data_path.h"

namespace crossgait::apps {
namespace {

using nlohmann::ordered_json;

struct GaitCommand {
  std::string gait = "trot";
  std::string robot = "scara_quadruped";
  std::vector<std::string> settings;
  double seconds = 0, dt = 0.02;
  bool list = false, parameters = false;
  std::string csv;
  PageOption page;
  JsonOption json;
};

/// The gait as this robot would walk it.
struct Chosen {
  std::shared_ptr<const RobotDescription> robot;
  GaitScale scale;
  LegArray<Vector3> p_BL;
  GaitChoice gait, usual;  ///< with and without --set
};

Chosen choose(const GaitCommand& options) {
  const auto robot = std::make_shared<const RobotDescription>(load_robot_with_warnings(options.robot));
  const GaitScale scale = gait_scale(*robot);
  return {robot, scale, leg_origins(*robot), choose_gait(options.gait, options.settings, {}, scale),
          choose_gait(options.gait, {}, {}, scale)};
}

void list_gaits(const JsonOption& json, const GaitScale& scale) {
  Table table({"gait", "lift-off FL FR RL RR", "duty", "cycle, s", "speed, m/s", "phases", ""});
  ordered_json entries = ordered_json::array();
  for (const Gait& reference : gaits()) {
    const Gait gait = scaled(reference, scale);
    std::string phases, offsets;
    ordered_json entry{{"name", gait.name}, {"summary", gait.summary}};
    for (const GaitPhase& phase : gait.phases) {
      if (phase.name.empty()) break;
      phases += fmt::format("{}{}", phases.empty() ? "" : ", ", phase.name);
      entry["phases"].push_back({{"name", phase.name}, {"start", phase.start}});
    }
    for (const Leg leg : kLegs) {
      offsets += fmt::format("{}{:.2f}", offsets.empty() ? "" : " ", gait.offset[leg]);
      entry["offset"][std::string(name(leg))] = gait.offset[leg];
    }
    const double speed = nominal_speed(gait.preferred);
    entry["duty_factor"] = gait.preferred.duty_factor;
    entry["nominal_speed_mps"] = speed;
    table.add_row({std::string(gait.name), offsets, fmt::format("{:.2f}", gait.preferred.duty_factor),
                   fmt::format("{:.2f}", gait.preferred.cycle_time), fmt::format("{:.3f}", speed), phases,
                   std::string(gait.summary)});
    entries.push_back(std::move(entry));
  }
  json.emit(table.str(), with_schema("gait", {{"gaits", std::move(entries)}}));
}

void list_parameters(const GaitCommand& options, const Chosen& of) {
  const GaitParameters& chosen = of.gait.parameters;
  const AdaptationRanges ranges = scaled(AdaptationRanges(), of.scale);
  Table table({"parameter", "unit", options.gait, "min", "max", "delta scale", "meaning"});
  ordered_json entries = ordered_json::array();
  for (const ParameterRow& reference : gait_parameters()) {
    const ParameterRow row = ranges.row(reference.name);
    const double value = chosen.*row.member;
    table.add_row({std::string(row.name), std::string(row.unit), fmt::format("{:.4g}", value),
                   fmt::format("{:.4g}", row.min), fmt::format("{:.4g}", row.max),
                   fmt::format("{:.4g}", row.delta_scale), std::string(row.help)});
    entries.push_back({{"name", row.name},
                       {"unit", row.unit},
                       {"value", value},
                       {"default", row.factor(of.scale.length) * row.default_value()},
                       {"min", row.min},
                       {"max", row.max},
                       {"delta_scale", row.delta_scale},
                       {"help", row.help}});
  }
  const std::string more = fmt::format("\nswing = {} (bezier or matched)\n", name(chosen.swing));
  options.json.emit(table.str() + more, with_schema("gait", {{"gait", options.gait},
                                                             {"parameters", std::move(entries)},
                                                             {"swing", name(chosen.swing)}}));
}

GaitGenerator make_generator(const Chosen& of) {
  return {*of.gait.gait, of.gait.parameters, of.p_BL, scaled(StepLimits(), of.scale)};
}

// One row per sample from t = 0: positions in the leg frames.
std::string targets_csv(const GaitCommand& options, GaitGenerator& generator, int rows) {
  std::string text = "t";
  const auto out = std::back_inserter(text);
  for (const Leg leg : kLegs) fmt::format_to(out, ",{0}.x,{0}.y,{0}.z", name(leg));
  text += '\n';
  for (int i = 0; i <= rows; ++i) {
    const LegArray<FootTarget>& targets = i == 0 ? generator.targets() : generator.update(options.dt);
    fmt::format_to(out, "{:.12g}", i * options.dt);
    for (const Leg leg : kLegs) {
      const Vector3& p = targets[leg].position;
      fmt::format_to(out, ",{:.17g},{:.17g},{:.17g}", p.x(), p.y(), p.z());
    }
    text += '\n';
  }
  return text;
}

void print_targets(const GaitCommand& options, const Provenance& provenance, GaitGenerator& generator,
                   int rows) {
  Table table({options.gait + ", t in s", "phase", "FL x, z mm", "FR x, z mm", "RL x, z mm", "RR x, z mm"});
  ordered_json samples = ordered_json::array();
  for (int i = 0; i <= rows; ++i) {
    const LegArray<FootTarget>& targets = i == 0 ? generator.targets() : generator.update(options.dt);
    std::vector<std::string> cells{fmt::format("{:.3f}", i * options.dt),
                                   std::string(generator.current_phase_name())};
    ordered_json sample{{"t", i * options.dt}, {"phase", generator.current_phase_name()}};
    for (const Leg leg : kLegs) {
      const FootTarget& foot = targets[leg];
      cells.push_back(fmt::format("{:6.1f} {:5.1f} {}", 1e3 * foot.position.x(), 1e3 * foot.position.z(),
                                  foot.swing ? "^" : "_"));
      sample[std::string(name(leg))] = {
          {"position_m", {foot.position.x(), foot.position.y(), foot.position.z()}}, {"swing", foot.swing}};
    }
    table.add_row(std::move(cells));
    samples.push_back(std::move(sample));
  }
  const std::string legend =
      "\n^ swing, _ stance; positions in the leg frames: x forward, z up from hips or shoulders\n";
  // Whoever takes the CSV from standard output takes nothing else there.
  options.json.emit(options.csv == "-" ? "" : table.str() + legend,
                    with_schema("gait", {{"gait", options.gait}, {"samples", std::move(samples)}}),
                    provenance);
}

// @param cycle  how long where no time is given, s
int row_count(const GaitCommand& options, double cycle) {
  constexpr double kMostRows = 1e6;
  const auto require = [](bool ok, const char* option, const std::string& expected, double found) {
    if (!ok) throw ConfigError("command line", option, expected, fmt::format("{}", found));
  };
  require(std::isfinite(options.seconds) && options.seconds >= 0, "--seconds", "a time in s",
          options.seconds);
  const double seconds = options.seconds > 0 ? options.seconds : cycle;
  require(options.dt > 0 && options.dt <= seconds && seconds / options.dt <= kMostRows, "--dt",
          fmt::format("a time step in ({:g}, {:g}] s, for {:g} s", seconds / kMostRows, seconds, seconds),
          options.dt);
  return static_cast<int>(std::lround(seconds / options.dt));
}

void run(const GaitCommand& options) {
  options.page.check();
  const Chosen of = choose(options);
  if (options.list) return list_gaits(options.json, of.scale);
  print_notes(parameter_notes(of.gait.parameters, of.usual.parameters, scaled(AdaptationRanges(), of.scale)));
  if (options.parameters) return list_parameters(options, of);
  GaitGenerator generator = make_generator(of);
  const int rows = row_count(options, generator.parameters().cycle_time);
  const Provenance provenance = options.json.provenance(of_gait(of.robot, of.gait));
  if (options.page.asked())
    options.page.write(gait_page(options.gait, make_generator(of), options.dt, rows), provenance);
  if (!options.csv.empty()) {
    GaitGenerator again = make_generator(of);
    const std::string text = targets_csv(options, again, rows);
    options.csv == "-" ? print_data(text) : write_file_atomically(options.csv, text);
    if (options.csv != "-") print_written(options.csv);
  }
  if (options.csv.empty() || !options.json.path.empty()) print_targets(options, provenance, generator, rows);
}

}  // namespace

void add_gait_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command =
      program.add_subcommand("gait", "The gaits, their parameters, and foot targets over time");
  command->footer(
      "\nExamples:\n"
      "  crossgait gait --list\n"
      "  crossgait gait --parameters --gait walk\n"
      "  crossgait gait --gait gallop --dt .05\n"
      "  crossgait gait --gait gallop --dt .002 --report gallop.html\n"
      "  crossgait gait --seconds 2 --dt .002 --set step_length=.08 --csv targets.csv");
  auto options = std::make_shared<GaitCommand>();
  CLI::Option* list = command->add_flag("--list", options->list, "List the gaits");
  CLI::Option* parameters = command->add_flag("--parameters", options->parameters,
                                              "List the tunable parameters and the gait's values");
  command->add_option("--gait", options->gait, "The gait to show")->capture_default_str();
  command->add_option("--set", options->settings, "Change a gait parameter; may be repeated")
      ->type_name("NAME=VALUE");
  command->add_option("--seconds", options->seconds, "How long; one cycle by default");
  command->add_option("--dt", options->dt, "Time between rows, s")->capture_default_str();
  add_output_option(*command, "--csv", options->csv, "Write t and foot positions (m) as CSV")
      ->type_name("FILE|-");
  options->page.add_to(*command, "Write a page that shows steps and paths of the feet, as one HTML file")
      ->excludes(list)
      ->excludes(parameters);
  add_robot_option(*command, options->robot);
  options->json.add_to(*command, invocation);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
