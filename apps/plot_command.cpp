// crossgait plot: pictures of a walk from its trace.
#include <algorithm>
#include <filesystem>
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/trace_figure.h"
#include "parity/stances.h"
#include "physics/core/error.h"
#include "physics/core/schema.h"
#include "physics/core/table.h"
#include "physics/robot_files/data_path.h"

namespace crossgait::apps {
namespace {

struct PlotCommandOptions {
  std::string trace, out;
  std::vector<std::string> what{"all"};
  std::string robot = "scara_quadruped";
  double shortest = kShortestContact;  // contact in the gait diagram, s
  bool constant = false;               // also parameters that never change
  JsonOption json;
};

using Rows = std::vector<Figure::Row>;

struct Kind {
  const char* name;
  Rows (*make)(const TraceTable& trace, const PlotCommandOptions& options);
};

RobotDescription robot_of(const PlotCommandOptions& options) { return load_robot(find_robot(options.robot)); }

// In the order in which they stand in a picture.
constexpr std::array<Kind, 5> kKinds{{
    {"gait", [](const TraceTable& trace,
                const PlotCommandOptions& options) { return gait_rows(trace, options.shortest); }},
    {"attitude", [](const TraceTable& trace, const PlotCommandOptions&) { return attitude_rows(trace); }},
    {"joints", [](const TraceTable& trace,
                  const PlotCommandOptions& options) { return joint_rows(trace, robot_of(options)); }},
    {"feet", [](const TraceTable& trace,
                const PlotCommandOptions& options) { return feet_rows(trace, robot_of(options)); }},
    {"parameters", [](const TraceTable& trace,
                      const PlotCommandOptions& options) { return parameter_rows(trace, options.constant); }},
}};

void check_what(const std::vector<std::string>& what) {
  std::string known = "all";
  for (const Kind& kind : kKinds) known += fmt::format(", {}", kind.name);
  for (const std::string& word : what) {
    const bool found = word == "all" || std::any_of(kKinds.begin(), kKinds.end(),
                                                    [&word](const Kind& kind) { return word == kind.name; });
    if (!found) throw ConfigError("command line", "--what", "one or more of " + known, "\"" + word + "\"");
  }
}

// By its name or with all others.
bool asked(const PlotCommandOptions& options, const char* kind) {
  return std::any_of(options.what.begin(), options.what.end(),
                     [kind](const std::string& word) { return word == kind || word == "all"; });
}

Figure make_figure(const PlotCommandOptions& options, const TraceTable& trace) {
  const auto named = [&options](const char* name) {
    return std::find(options.what.begin(), options.what.end(), name) != options.what.end();
  };
  Figure figure;
  figure.title = std::filesystem::path(options.trace).filename().string();
  for (const Kind& kind : kKinds) {
    if (!asked(options, kind.name)) continue;
    Rows rows = kind.make(trace, options);
    // A walk without a gait has no parameters to show: left out of "all", an error if asked for.
    if (rows.empty() && named(kind.name)) {
      const bool none = constant_parameters(trace).empty();
      throw ConfigError(options.trace, "columns \"param.<name>\"",
                        none ? "at least one" : "one that changes (--constant draws the others too)", "none");
    }
    std::move(rows.begin(), rows.end(), std::back_inserter(figure.rows));
  }
  return figure;
}

void run(const PlotCommandOptions& options) {
  check_plot_path(options.out, "--out");
  check_what(options.what);
  const TraceTable trace(options.trace);
  const Figure figure = make_figure(options, trace);
  draw(figure, options.out);
  const double from = trace.time().front(), to = trace.time().back();
  std::string text =
      fmt::format("{}: {} of {}, {:.3f} to {:.3f} s\n", options.out, counted(figure.panel_count(), "panel"),
                  counted(trace.rows(), "row"), from, to);
  std::vector<std::string> hidden;
  if (!options.constant && asked(options, "parameters")) hidden = constant_parameters(trace);
  if (!hidden.empty())
    text += fmt::format("not drawn, since they never change (--constant): {}\n", fmt::join(hidden, ", "));
  options.json.emit(text, with_schema("plot", {{"file", options.out},
                                               {"panels", figure.panel_count()},
                                               {"rows", trace.rows()},
                                               {"from_s", from},
                                               {"to_s", to},
                                               {"constant_parameters", hidden}}));
}

}  // namespace

void add_plot_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("plot", "Pictures of a walk from its trace");
  command->footer(
      "\n  gait        which feet were on the ground when, and were meant to be\n"
      "  attitude    height, roll, pitch, speed and yaw rate of the base\n"
      "  joints      angles of the servos and their targets\n"
      "  feet        paths of the feet in the leg frames\n"
      "  parameters  parameters of the gait that change\n"
      "\nExamples:\n"
      "  crossgait walk --seconds 3 --trace walk.csv && crossgait plot walk.csv --out walk.png\n"
      "  crossgait plot walk.csv --what gait,parameters --out walk.svg");
  auto options = std::make_shared<PlotCommandOptions>();
  command->add_option("trace", options->trace, "A file that `crossgait walk --trace` wrote")
      ->type_name("TRACE.csv")
      ->required();
  add_output_option(*command, "--out", options->out, "The picture")
      ->type_name("FILE.svg|FILE.png")
      ->required();
  command
      ->add_option("--what", options->what, "Comma-separated: all, gait, attitude, joints, feet, parameters")
      ->delimiter(',')
      ->capture_default_str();
  command
      ->add_option("--shortest-contact", options->shortest,
                   "Touches, and gaps between them, that the gait diagram leaves out if they are shorter, s")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_flag("--constant", options->constant, "Also a panel for every parameter that never changes");
  add_robot_option(*command, options->robot);
  options->json.add_to(*command);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
