// crossgait compare: the same walk in several engines, side by side.
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crossgait/apps/verdict_options.h"
#include "crossgait/backends/registry.h"
#include "crossgait/parity/report.h"
#include "crossgait/parity/verdict_report.h"
#include "crossgait/physics/error.h"

namespace crossgait::apps {
namespace {

struct Options {
  std::vector<std::string> engines;
  WorldOptions world;
  WalkOptions walk;
  DivergenceTolerances tolerances;
  std::string trace;
  bool verdict = false;
  JsonOption json;
};

// walk.csv -> walk.bullet-matched.csv
std::string trace_path(const std::string& path, std::string backend) {
  std::replace(backend.begin(), backend.end(), ':', '-');
  const std::filesystem::path p(path);
  return (p.parent_path() / (p.stem().string() + "." + backend + p.extension().string())).string();
}

void check_engines(const std::vector<std::string>& engines) {
  if (engines.size() < 2) {
    throw ConfigError("command line", "--engines", "two or more engines", fmt::format("{}", engines.size()));
  }
  for (std::size_t i = 0; i < engines.size(); ++i) {
    if (std::find(engines.begin(), engines.begin() + static_cast<std::ptrdiff_t>(i), engines[i]) !=
        engines.begin() + static_cast<std::ptrdiff_t>(i)) {
      throw ConfigError("command line", "--engines", "each engine once", engines[i] + " again");
    }
  }
}

// Of every pair that does not share a contact law; half as many starts as `crossgait verdict` takes.
std::vector<Verdict> verdicts(const Options& options, const WorldSpec& spec, const Comparison& comparison) {
  std::vector<Verdict> result;
  SpreadOptions how;
  how.verdict.starts = 6;
  const Behaviour behaviour = walk_behaviour(options.world, options.walk, spec, how.spread);
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    for (std::size_t k = i + 1; k < comparison.runs.size(); ++k) {
      const EngineInfo &a = comparison.runs[i].engine, &b = comparison.runs[k].engine;
      if (a.laws == b.laws) continue;
      ProgressLine progress(fmt::format("judging {} and {}", a.name, b.name));
      result.push_back(reach_verdict(behaviour, find_engine(a.name), find_engine(b.name), how.verdict,
                                     [&](double share) { progress.update(share); }));
    }
  }
  return result;
}

void run(const Options& options) {
  const WorldSpec spec = options.world.make();
  const WalkSetup setup = options.walk.make(*spec.robot);
  const std::vector<std::string> engines = options.engines.empty() ? available_engines() : options.engines;
  check_engines(engines);
  std::vector<std::unique_ptr<PhysicsBackend>> backends;
  for (const std::string& engine : engines) backends.push_back(make_backend(engine, spec));

  Comparison comparison;
  {
    ProgressLine progress("comparing");
    comparison =
        compare_engines(backends, setup, options.tolerances, [&](double share) { progress.update(share); });
  }
  if (!options.trace.empty()) {
    for (const WalkRun& walk : comparison.runs) {
      write_trace_csv(*spec.robot, walk.trace, trace_path(options.trace, walk.engine.name));
    }
  }
  std::string text = describe(comparison);
  nlohmann::ordered_json json = to_json(comparison);
  if (options.verdict) {
    for (const Verdict& verdict : verdicts(options, spec, comparison)) {
      text += "\n" + describe(verdict);
      json["verdicts"].push_back(to_json(verdict));
    }
  } else {
    text +=
        "\nPhysics or engine? --verdict weighs the gaps against the spread within an engine (60 more walks a "
        "pair).\n";
  }
  options.json.emit(text, json);
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
  auto options = std::make_shared<Options>();
  command->add_option("--engines", options->engines, "Comma-separated; all that are built in by default")
      ->delimiter(',');
  options->world.add_to(*command);
  options->walk.add_to(*command);
  command
      ->add_option("--position-tolerance", options->tolerances.position,
                   "When two engines count as apart, m (engines with the same contact law: 1e-6)")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->add_option("--joint-tolerance", options->tolerances.joint, "The same for joint angles, rad")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->add_option("--attitude-tolerance", options->tolerances.attitude, "The same for orientation, rad")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--trace", options->trace, "Write one CSV per engine: FILE.csv becomes FILE.<engine>.csv")
      ->type_name("FILE.csv");
  command->add_flag(
      "--verdict", options->verdict,
      "Also judge whether the difference is the engine's (60 more runs per pair; see `crossgait "
      "verdict`)");
  options->json.add_to(*command);
  command->callback([options] { run(*options); });
}

}  // namespace crossgait::apps
