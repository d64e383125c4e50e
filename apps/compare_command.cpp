// crossgait compare: the same walk in several engines, side by side.
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crossgait/apps/walk_options.h"
#include "crossgait/backends/registry.h"
#include "crossgait/parity/report.h"
#include "crossgait/parity/verdict_report.h"
#include "crossgait/physics/data_path.h"
#include "crossgait/study/rollout.h"
#include "crossgait/study/walk.h"

namespace crossgait::apps {
namespace {

struct CompareCommand {
  std::vector<std::string> engines;
  WalkOptions walk;
  CompareOptions compare;
  std::string trace;
  JsonOption json;
};

// walk.csv -> walk.bullet-matched.csv
std::string trace_path(const std::string& path, std::string backend) {
  std::replace(backend.begin(), backend.end(), ':', '-');
  const std::filesystem::path p(path);
  return (p.parent_path() / (p.stem().string() + "." + backend + p.extension().string())).string();
}

constexpr const char* kHint =
    "\nPhysics or engine? --verdict weighs the gaps against the spread within an engine (60 more walks a "
    "pair).\n";

void run(const CompareCommand& options) {
  const WalkConfig config = options.walk.make();
  const std::vector<std::string> engines = options.engines.empty() ? available_engines() : options.engines;
  Stages stages;
  const WalkComparison result = compare_walks(config, engines, options.compare, stages.progress());
  if (!options.trace.empty()) {
    const RobotDescription robot = load_robot(find_robot(config.robot));
    for (const WalkRun& walk : result.comparison.runs)
      write_trace_csv(robot, walk.trace, trace_path(options.trace, walk.engine.name));
  }
  std::string text = describe(result.comparison);
  for (const Verdict& verdict : result.verdicts) text += "\n" + describe(verdict);
  if (!options.compare.verdict) text += kHint;
  options.json.emit(text, report(result));
}

}  // namespace

void add_compare_command(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("compare", "The same walk in several engines, side by side: the parity report");
  command->footer(
      "\nExamples:\n"
      "  crossgait compare\n"
      "  crossgait compare --terrain rough --seed 7 --seconds 10\n"
      "  crossgait compare --engines mujoco,bullet --friction .4 --json parity.json");
  auto options = std::make_shared<CompareCommand>();
  command->add_option("--engines", options->engines, "Comma-separated; all that are built in by default")
      ->delimiter(',');
  options->walk.add_to(*command);
  command
      ->add_option("--position-tolerance", options->compare.tolerances.position,
                   "When two engines count as apart, m (engines with the same contact law: 1e-6)")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--joint-tolerance", options->compare.tolerances.joint, "The same for joint angles, rad")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--attitude-tolerance", options->compare.tolerances.attitude,
                   "The same for orientation, rad")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--trace", options->trace, "Write one CSV per engine: FILE.csv becomes FILE.<engine>.csv")
      ->type_name("FILE.csv");
  command->add_flag(
      "--verdict", options->compare.verdict,
      "Also judge whether the difference is the engine's (60 more runs per pair; see `crossgait "
      "verdict`)");
  options->compare.judge.workers = EpisodeOptions::default_workers();
  options->json.add_to(*command);
  command->callback([options] { run(*options); });
}

}  // namespace crossgait::apps
