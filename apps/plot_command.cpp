// crossgait plot: pictures of a walk from its trace.
#include <algorithm>
#include <filesystem>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crossgait/apps/command.h"
#include "crossgait/apps/trace_figure.h"
#include "crossgait/parity/schema.h"
#include "crossgait/physics/data_path.h"
#include "crossgait/physics/error.h"

namespace crossgait::apps {
namespace {

struct PlotCommandOptions {
  std::string trace, out;
  std::vector<std::string> what{"all"};
  std::string robot = "scara_quadruped";
  JsonOption json;
};

using Rows = std::vector<Figure::Row>;

struct Kind {
  const char* name;
  Rows (*make)(const TraceTable& trace, const std::string& robot);
};

// In the order in which they stand in a picture.
constexpr std::array<Kind, 5> kKinds{{
    {"gait", [](const TraceTable& trace, const std::string&) { return gait_rows(trace); }},
    {"attitude", [](const TraceTable& trace, const std::string&) { return attitude_rows(trace); }},
    {"joints", [](const TraceTable& trace,
                  const std::string& robot) { return joint_rows(trace, load_robot(find_robot(robot))); }},
    {"feet", [](const TraceTable& trace,
                const std::string& robot) { return feet_rows(trace, load_robot(find_robot(robot))); }},
    {"parameters", [](const TraceTable& trace, const std::string&) { return parameter_rows(trace); }},
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

Figure make_figure(const PlotCommandOptions& options, const TraceTable& trace) {
  const auto asked = [&options](const char* name) {
    return std::find(options.what.begin(), options.what.end(), name) != options.what.end();
  };
  Figure figure;
  figure.title = std::filesystem::path(options.trace).filename().string();
  for (const Kind& kind : kKinds) {
    if (!asked(kind.name) && !asked("all")) continue;
    Rows rows = kind.make(trace, options.robot);
    // A walk without a gait has no parameters to show: left out of "all", an error if asked for.
    if (rows.empty() && asked(kind.name)) {
      throw ConfigError(options.trace, "line 1", "columns \"param.<name>\"", "none");
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
  options.json.emit(fmt::format("{}: {} panels of {} rows, {:.3f} to {:.3f} s\n", options.out,
                                figure.panel_count(), trace.rows(), from, to),
                    with_schema("plot", {{"file", options.out},
                                         {"panels", figure.panel_count()},
                                         {"rows", trace.rows()},
                                         {"from_s", from},
                                         {"to_s", to}}));
}

}  // namespace

void add_plot_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("plot", "Pictures of a walk from its trace");
  command->footer(
      "\n  gait        which feet were on the ground when\n"
      "  attitude    height, roll, pitch, speed and yaw rate of the base\n"
      "  joints      angles of the servos and their targets\n"
      "  feet        paths of the feet in the leg frames\n"
      "  parameters  parameters of the gait\n"
      "\nExamples:\n"
      "  crossgait walk --seconds 3 --trace walk.csv && crossgait plot walk.csv --out walk.png\n"
      "  crossgait plot walk.csv --what gait,parameters --out walk.svg");
  auto options = std::make_shared<PlotCommandOptions>();
  command->add_option("trace", options->trace, "A file that `crossgait walk --trace` wrote")
      ->type_name("TRACE.csv")
      ->required();
  command->add_option("--out", options->out, "The picture")->type_name("FILE.svg|FILE.png")->required();
  command
      ->add_option("--what", options->what, "Comma-separated: all, gait, attitude, joints, feet, parameters")
      ->delimiter(',')
      ->capture_default_str();
  add_robot_option(*command, options->robot);
  options->json.add_to(*command);
  command->callback([options] { run(*options); });
}

}  // namespace crossgait::apps
