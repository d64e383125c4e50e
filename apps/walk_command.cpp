// crossgait walk: one run in one engine.
#include <fmt/format.h>
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
#include "study/policy_walk.h"
#include "study/walk.h"

namespace crossgait::apps {
namespace {

std::string first_available() { return available_engines().empty() ? "none" : available_engines().front(); }

struct WalkCommand {
  std::string engine = first_available();
  WalkOptions walk;
  PolicyOption policy;
  std::string trace;
  PageOption page;
  JsonOption json;
};

ReportPage page_of_walk(const WorldSpec& world, const WalkRun& run, std::vector<RunRecording>& recordings) {
  ReportPage page = page_of_walks(world, {run}, {}, recordings);
  page.summary = summary(run);
  return page;
}

void run_policy(const WalkCommand& options) {
  const LoadedEnv environment = options.policy.environment(options.walk);
  const std::uint64_t seed = environment.config.terrain_seed;
  const Provenance provenance =
      options.json.provenance({policy_subject(environment, {options.policy.policy}, seed),
                               {options.engine},
                               {{"--engine", {options.engine}}}});
  options.page.check(environment.config);
  std::vector<RunRecording> recordings;
  recordings.emplace_back(environment.robot, options.trace, options.page.asked());
  note_cost({options.engine}, environment, environment.config.episode_seconds, 1, "this walk");
  ProgressLine progress(fmt::format("{} in {}", short_name(options.policy.policy), options.engine));
  TraceSinks sinks;
  if (TraceSink* const sink = recordings.front().sink()) sinks.push_back(sink);
  const Comparison result = compare_episodes(
      environment, options.policy.policy, {options.engine}, seed, {},
      [&](double share) { progress.update(share); }, sinks);
  recordings.front().finish_trace();
  if (result.interrupted) throw EndedEarly("nothing is written");
  if (options.page.asked())
    options.page.write(page_of_walk(EnvModel::make(environment)->world, result.runs.front(), recordings),
                       provenance);
  options.json.emit(describe(result.runs.front()), report(result.runs.front()), provenance);
}

void run(const WalkCommand& options) {
  if (options.policy.asked()) return run_policy(options);
  const LoadedWalk loaded = options.walk.make();
  const WalkConfig& config = loaded.config;
  const Provenance provenance = options.json.provenance(
      {WalkOptions::subject(loaded), {options.engine}, {{"--engine", {options.engine}}}});
  options.page.check(config);
  std::vector<RunRecording> recordings;
  recordings.emplace_back(loaded.world.robot, options.trace, options.page.asked());

  note_cost({options.engine}, loaded.world, config.timing);
  ProgressLine progress(fmt::format("{} in {}", config.gait.name(), options.engine));
  const auto world = find_engine(options.engine).make(loaded.world);
  const WalkRun run = record_walk(
      *world, config.setup(), [&](double share) { progress.update(share); }, recordings.front().sink());
  recordings.front().finish_trace();
  if (options.page.asked()) options.page.write(page_of_walk(loaded.world, run, recordings), provenance);
  options.json.emit(describe(run), report(run), provenance);
  if (run.interrupted) throw EndedEarly(how_far(run.summary.simulated_seconds, config.timing.seconds));
}

}  // namespace

void add_walk_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command = program.add_subcommand("walk", "Walk in one engine: a summary and, if asked, a trace");
  command->footer(
      "\nExamples:\n"
      "  crossgait walk\n"
      "  crossgait walk --engine bullet --terrain rough --seed 3 --seconds 10\n"
      "  crossgait walk --set step_length=.08 --set cycle_time=1 --trace walk.csv --json -\n"
      "  crossgait walk --policy serial_joints --seconds 5");
  auto options = std::make_shared<WalkCommand>();
  command->add_option("--engine", options->engine, "Engine and mode (see `crossgait engines`)")
      ->capture_default_str();
  options->walk.add_to(*command);
  options->policy.add_to(*command);
  add_output_option(*command, "--trace", options->trace,
                    "Write state, targets and contacts of every control step as CSV");
  options->page.add_to(*command);
  options->json.add_to(*command, invocation);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
