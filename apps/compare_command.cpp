// crossgait compare: the same walk in several engines, side by side.
#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "apps/env_options.h"
#include "apps/interruption.h"
#include "apps/page_option.h"
#include "apps/policy_option.h"
#include "apps/step_cost.h"
#include "apps/walk_options.h"
#include "backends/registry.h"
#include "parity/answer.h"
#include "parity/report.h"
#include "physics/core/error.h"
#include "report/verdict_document.h"
#include "study/policy_walk.h"
#include "study/rollout.h"
#include "study/walk.h"

namespace crossgait::apps {
namespace {

struct CompareCommand {
  std::vector<std::string> engines;
  WalkOptions walk;
  PolicyOption policy;
  CompareOptions compare;
  bool require = false, brief = false;
  std::string trace;
  PageOption page;
  JsonOption json;
};

// walk.csv -> walk.bullet-matched.csv
std::string trace_path(const std::string& path, std::string engine) {
  std::replace(engine.begin(), engine.end(), ':', '-');
  const std::filesystem::path p(path);
  return (p.parent_path() / (p.stem().string() + "." + engine + p.extension().string())).string();
}

std::vector<DerivedOutput> traces_of(const CompareCommand& options, const std::vector<std::string>& engines) {
  std::vector<DerivedOutput> traces;
  if (options.trace.empty()) return traces;
  for (const std::string& engine : engines) traces.push_back({"--trace", trace_path(options.trace, engine)});
  return traces;
}

// What is asked for of every engine's walk: one trace each, and its steps for a page.
std::vector<RunRecording> recordings_of(const CompareCommand& options, const WorldSpec& world,
                                        const std::vector<std::string>& engines) {
  std::vector<RunRecording> recordings;
  for (const std::string& engine : engines) {
    recordings.emplace_back(world.robot, options.trace.empty() ? "" : trace_path(options.trace, engine),
                            options.page.asked());
  }
  return recordings;
}

TraceSinks sinks_of(std::vector<RunRecording>& recordings) {
  TraceSinks sinks;
  for (RunRecording& recording : recordings) {
    if (TraceSink* const sink = recording.sink()) sinks.push_back(sink);
  }
  return sinks;  // of all, or of none
}

ReportPage page_of(const WalkComparison& result, const WorldSpec& world,
                   std::vector<RunRecording>& recordings) {
  ReportPage page = page_of_walks(world, result.comparison.runs, result.comparison.pairs, recordings);
  page.summary = summary(result.comparison);
  page.groups = describe_groups(result.comparison);
  page.sentences = describe_parity(result.comparison);
  if (result.verdict) verdict_document(to_json(*result.verdict), "verdict").add_to(page);
  return page;
}

void check_required(const CompareCommand& options, const std::vector<std::string>& engines) {
  if (!options.require) return;
  for (std::size_t i = 0; i < engines.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (find_engine(engines[i]).info.laws == find_engine(engines[k]).info.laws) return;
    }
  }
  throw ConfigError("command line", "--require", "two engines that follow the same laws",
                    fmt::format("{}", fmt::join(engines, ",")));
}

std::string describe_verdict(const WalkComparison& result) {
  std::string text;
  if (result.verdict) text = fmt::format("\n{}", describe(*result.verdict));
  for (const PairDifference& pair : result.comparison.pairs) {
    if (!pair.same_laws) continue;
    text += fmt::format(
        "\n{} and {} follow the same laws: whether they are the same is the question of parity above, and no "
        "verdict's.\n",
        pair.a, pair.b);
  }
  return text;
}

std::string text_of(const CompareCommand& options, const Comparison& comparison) {
  return options.brief ? describe_briefly(comparison) : describe(comparison);
}

constexpr const char* kHint =
    "\nPhysics or engine? --verdict judges the gaps from several starts, against margins that are stated.\n";

void require_parity(const CompareCommand& options, const Comparison& comparison) {
  const std::vector<std::string> missed = missed_parity(comparison);
  if (options.require && !missed.empty())
    throw std::runtime_error(fmt::format("parity is required, and missed by {}", fmt::join(missed, "; ")));
}

void run_policy(const CompareCommand& options) {
  if (options.compare.verdict)
    throw ConfigError("command line", "--verdict", "a walk; `crossgait verdict --policy` judges policies",
                      options.policy.policy);
  const LoadedEnv environment = options.policy.environment(options.walk);
  const std::uint64_t seed = environment.config.terrain_seed;
  const std::vector<std::string> engines = engines_or_all(options.engines);
  if (engines.size() < 2)
    throw ConfigError("compare", "engines", "two or more", fmt::format("{}", fmt::join(engines, ",")));
  check_required(options, engines);
  const Provenance provenance = options.json.provenance(
      {policy_subject(environment, {options.policy.policy}, seed), engines, {{"--engines", engines}}});
  options.page.check(environment.config);
  const WorldSpec world = EnvModel::make(environment)->world;
  std::vector<RunRecording> recordings = recordings_of(options, world, engines);
  note_cost(engines, environment, environment.config.episode_seconds, 1, "this walk");
  ProgressLine progress(short_name(options.policy.policy));
  WalkComparison result;
  result.comparison = compare_episodes(
      environment, options.policy.policy, engines, seed, options.compare.tolerances,
      [&](double share) { progress.update(share); }, sinks_of(recordings));
  for (RunRecording& recording : recordings) recording.finish_trace();
  if (result.comparison.interrupted) throw EndedEarly("nothing is written");
  if (options.page.asked()) options.page.write(page_of(result, world, recordings), provenance);
  options.json.emit(text_of(options, result.comparison), report(result), provenance);
  require_parity(options, result.comparison);
}

void run(const CompareCommand& options) {
  if (options.policy.asked()) return run_policy(options);
  const LoadedWalk loaded = options.walk.make();
  const WalkConfig& config = loaded.config;
  const std::vector<std::string> engines = engines_or_all(options.engines);
  check_required(options, engines);
  const Provenance provenance = options.json.provenance(
      {WalkOptions::subject(loaded), engines, {{"--engines", engines}}, traces_of(options, engines)});
  options.page.check(config);
  std::vector<RunRecording> recordings = recordings_of(options, loaded.world, engines);
  note_cost(engines, loaded.world, config.timing);
  Stages stages;
  const WalkComparison result =
      compare_walks(loaded, engines, options.compare, stages.progress(), sinks_of(recordings));
  for (RunRecording& recording : recordings) recording.finish_trace();
  if (options.page.asked()) options.page.write(page_of(result, loaded.world, recordings), provenance);
  options.json.emit(text_of(options, result.comparison) + (options.compare.verdict ? describe_verdict(result)
                                                           : options.brief         ? ""
                                                                                   : kHint),
                    report(result), provenance);
  if (result.interrupted) {
    throw EndedEarly(
        how_far(result.comparison.runs.front().summary.simulated_seconds, config.timing.seconds));
  }
  require_parity(options, result.comparison);
}

}  // namespace

void add_compare_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command =
      program.add_subcommand("compare", "The same walk in several engines, side by side: the parity report");
  command->footer(
      "\nExamples:\n"
      "  crossgait compare\n"
      "  crossgait compare --terrain rough --seed 7 --seconds 10\n"
      "  crossgait compare --engines mujoco,bullet --friction .4 --json parity.json\n"
      "  crossgait compare --engines mujoco,bullet:matched --require\n"
      "  crossgait compare --policy serial_joints --engines mujoco,bullet --seconds 5");
  auto options = std::make_shared<CompareCommand>();
  command->add_option("--engines", options->engines, "Comma-separated; all that are built in by default")
      ->delimiter(',');
  options->walk.add_to(*command);
  options->policy.add_to(*command);
  command
      ->add_option("--position-tolerance", options->compare.tolerances.position,
                   "When two engines count as apart, m (engines with the same contact law: 1e-6)")
      ->capture_default_str()
      ->check(above_zero());
  command
      ->add_option("--joint-tolerance", options->compare.tolerances.joint, "The same for joint angles, rad")
      ->capture_default_str()
      ->check(above_zero());
  command
      ->add_option("--attitude-tolerance", options->compare.tolerances.attitude,
                   "The same for orientation, rad")
      ->capture_default_str()
      ->check(above_zero());
  add_output_option(*command, "--trace", options->trace,
                    "Write one CSV per engine: FILE.csv becomes FILE.<engine>.csv");
  options->page.add_to(*command);
  command->add_flag("--brief", options->brief, "Print the answer and the groups of engines alone")
      ->group(kExecution);
  command->add_flag("--require", options->require,
                    "Exit code 1 if engines of the same laws are not the same: in any control step from the "
                    "same state, within 1e-9 m and rad, and over the first second, within 1e-6, as "
                    "far as single steps can come to that. Beyond it chaos parts even equal laws");
  command->add_flag(
      "--verdict", options->compare.verdict,
      "Also judge from six starts whether the difference is the engine's (see `crossgait verdict`)");
  options->compare.judge.workers = EpisodeOptions::default_workers();
  options->json.add_to(*command, invocation);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
