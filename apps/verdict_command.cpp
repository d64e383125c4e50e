// crossgait verdict: does a behaviour depend on the engine it was tried in?
#include <algorithm>
#include <optional>

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
#include "physics/core/error.h"
#include "physics/engine/world_quantities.h"
#include "report/verdict_document.h"
#include "study/engine_comparison.h"
#include "study/run_store.h"

namespace crossgait::apps {
namespace {

struct VerdictCommand {
  std::vector<std::string> engines;
  WalkOptions walk;
  StartRanges starts;
  JudgeOptions judge;
  std::vector<std::string> margins;
  std::string margin_file, require;
  std::optional<std::string> against;  ///< another setup
  PolicyOption policy;
  PageOption page;
  JsonOption json;
};

LoadedBehaviour behaviour(const VerdictCommand& options) {
  if (!options.policy.asked()) {
    const LoadedWalk walk = options.walk.make();
    return {walk, options.starts, walk.config.terrain_seed};
  }
  return {options.policy.environment(options.walk), options.policy.policy, options.starts,
          options.walk.config.terrain_seed};
}

// @param alone  one engine is enough: it is held against itself under another setup
std::vector<std::string> chosen_engines(const std::vector<std::string>& asked, bool alone) {
  std::vector<std::string> engines = asked;
  const std::vector<std::string> all = available_engines();
  if (alone) {
    if (engines.empty() && !all.empty()) engines = {all.front()};
    if (engines.empty()) throw ConfigError("command line", "--engines", "one engine or more", "none");
    return engines;
  }
  if (engines.empty() && !all.empty()) {
    // The first one, and the first that solves other laws.
    const Laws laws = find_engine(all.front()).info.laws;
    const auto other = std::find_if(all.begin(), all.end(), [&laws](const std::string& name) {
      return find_engine(name).info.laws != laws;
    });
    engines = {all.front()};
    if (other != all.end()) engines.push_back(*other);
  }
  if (engines.size() < 2) {
    throw ConfigError("command line", "--engines", "two or more engines",
                      fmt::format("{}", fmt::join(engines, ",")));
  }
  return engines;
}

// Of one run, with the standing before it, s.
double seconds_of(const LoadedBehaviour& behaviour) {
  if (const auto* walk = std::get_if<LoadedWalk>(&behaviour.what))
    return walk->config.timing.settle_seconds + walk->config.timing.seconds;
  const EnvConfig& config = std::get_if<LoadedPolicy>(&behaviour.what)->model->config;
  return config.settle_seconds + config.episode_seconds;
}

// After an interruption.
std::string what_is_kept(const std::string& stored_runs) {
  if (stored_runs.empty()) return "nothing is kept; with --runs FILE.jsonl it would go on from here";
  return fmt::format("{} in {}; the same command goes on from here",
                     counted(count_stored_runs(stored_runs), "run"), stored_runs);
}

ReportPage page_of(const EngineComparison& judged) {
  ReportPage page;
  page.title = judged.verdicts.pairs.front().behaviour;
  verdict_document(to_json(judged), "verdict").add_to(page);
  return page;
}

// Exit code 0 for the word that is required, and one for each that is found in its place.
int exit_code(Word found, const std::string& required) {
  if (required.empty() || name(found) == required) return 0;
  switch (found) {
    case Word::kAgrees:
      return 3;
    case Word::kDiffers:
      return 4;
    case Word::kStepDependent:
      return 5;
    case Word::kUnresolved:
      break;
  }
  return 6;
}

void run(const VerdictCommand& options) {
  const std::vector<std::string> engines = chosen_engines(options.engines, options.against.has_value());
  options.page.check();
  const LoadedBehaviour loaded = behaviour(options);
  JudgeOptions judge = options.judge;
  if (options.against) judge.against = read_setup(*options.against, loaded.world());
  const Provenance provenance =
      options.json.provenance({loaded.described, engines, {{"--engines", engines}}});
  note_cost(engines, loaded.world(), static_cast<double>(judge.verdict.starts) * seconds_of(loaded),
            "its starts");
  Stages stages;
  std::optional<EngineComparison> judged;
  try {
    judged = judge_engines(loaded, engines, judge, stages.progress());
  } catch (const Interrupted&) {
    throw EndedEarly(what_is_kept(options.judge.stored_runs));
  }
  if (options.page.asked()) options.page.write(page_of(*judged), provenance);
  options.json.emit(describe(*judged), to_json(*judged), provenance);
  print_notes(judged->notes);
  const Word word = word_of(*judged);
  if (const int code = exit_code(word, options.require)) {
    throw RequirementMissed(
        code, fmt::format("'{}' is required, and the word is '{}'", options.require, name(word)));
  }
}

std::string against_help() {
  std::string names;
  for (const WorldQuantity& quantity : world_quantities())
    names += fmt::format("{}{}", names.empty() ? "" : ", ", quantity.name);
  return fmt::format(
      "Hold an engine (or several, each) against itself under another setup: the same world with these "
      "changes, each a "
      "value or a factor (mass=x1.1). Quantities: {}; and robot=FILE, another file of the same robot",
      names);
}

void add_judge_options(CLI::App& command, VerdictCommand& options) {
  VerdictOptions& verdict = options.judge.verdict;
  StartRanges& starts = options.starts;
  command
      .add_option("--starts", verdict.starts,
                  "Starts that every engine runs from, at least 4; words from 6 on")
      ->check(CLI::Range(4, 10000))
      ->capture_default_str();
  command
      .add_option(
          "--looks", verdict.looks,
          "Look so many times at most, after as many starts each, and end with the first that settles "
          "every pair: error is shared among them")
      ->check(CLI::Range(1, 20))
      ->capture_default_str();
  command
      .add_option(
          "--margin", options.margins,
          "KEY=MARGIN: the difference in a statistic that would not matter, as a share (5%), an amount "
          "(0.02; 0.004/s for each second) or the larger of both (5%,0.02). May be repeated")
      ->type_name("KEY=MARGIN")
      ->allow_extra_args(false);
  command.add_option("--margins", options.margin_file, "The same as YAML, a line of KEY: MARGIN each")
      ->type_name("FILE.yaml");
  command
      .add_option("--failure-margin", verdict.failures,
                  "The same for the share of runs that fail, or slide, ...")
      ->capture_default_str();
  command
      .add_option("--confidence", verdict.confidence,
                  "Confidence of all intervals of all pairs together, between 0 and 1")
      ->capture_default_str();
  command
      .add_option("--offset", starts.position_m,
                  "How far starts lie apart, each way, m; 0.1 for scara_quadruped, by size for others")
      ->check(CLI::Range(0.0, StartRanges::kMostPosition));
  command.add_option("--heading", starts.heading_rad, "How far headings differ, each way, rad")
      ->check(CLI::Range(0.0, StartRanges::kMostHeading))
      ->capture_default_str();
  command
      .add_option(
          "--push", starts.push_mps,
          "Push in the first second, as a speed of the robot, m/s; 0.02 for scara_quadruped, by size for "
          "others")
      ->check(CLI::Range(0.0, StartRanges::kMostPush));
  add_workers_option(command, verdict.workers);
  add_output_option(
      command, "--runs", options.judge.stored_runs,
      "Take runs that this file holds, and add those that it does not: a verdict that was stopped "
      "goes on, one that is repeated costs nothing")
      ->type_name(kStoreType);
}

}  // namespace

void add_verdict_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command = program.add_subcommand(
      "verdict",
      "Does a behaviour depend on the engine? Gaps between engines, against margins that are stated");
  command->footer(
      "\nExamples:\n"
      "  crossgait verdict\n"
      "  crossgait verdict --explain\n"
      "  crossgait verdict --against friction=0.4,mass=x1.1,delay=0.004 --explain\n"
      "  crossgait verdict --robots my.urdf,my.xml --explain\n"
      "  crossgait verdict --engines mujoco,bullet,dart+pyramid,dart+stock\n"
      "  crossgait verdict --gait gallop --terrain rough --starts 24 --json verdict.json\n"
      "  crossgait verdict --margin distance_m=5% --margin slip_m=0.05 --require agrees\n"
      "  crossgait verdict --policy policy.safetensors --config env.yaml\n"
      "With --require WORD the exit code is 0 for that word, else 3 for agrees, 4 for differs, 5 for\n"
      "step-dependent, 6 for unresolved. docs/verdict.md has the rule and the margins.");
  auto options = std::make_shared<VerdictCommand>();
  command
      ->add_option("--engines", options->engines,
                   "Two or more, comma-separated; by default the first that there is, and the first of other "
                   "laws, and with --against the first alone. Of more than two: which agree, and whether one "
                   "stands apart")
      ->delimiter(',');
  command->add_option("--against", options->against, against_help())->type_name("NAME=VALUE,...");
  options->walk.add_to(*command);
  command
      ->add_option_function<std::vector<std::string>>(
          "--robots",
          [options](const std::vector<std::string>& two) {
            options->walk.config.robot = two[0];
            options->against = "robot=" + two[1];
          },
          "Two descriptions of one robot, held against each other: --robot A --against robot=B")
      ->type_name("A,B")
      ->delimiter(',')
      ->expected(2)
      ->excludes("--robot")
      ->excludes("--against");
  options->judge.verdict.workers = EpisodeOptions::default_workers();
  add_judge_options(*command, *options);
  options->policy.add_to(*command);
  command->add_flag(
      "--explain", options->judge.explain,
      "Also say what the gap comes from, one modelling factor, or change of --against, at a time");
  command
      ->add_option(
          "--require", options->require,
          "End with an exit code of its own for every other word: 3 agrees, 4 differs, 5 step-dependent, 6 "
          "unresolved")
      ->check(CLI::IsMember({"agrees", "differs", "step-dependent", "unresolved"}));
  options->page.add_to(*command, "Write a page that shows every gap against its margin, as one HTML file");
  options->json.add_to(*command, invocation);
  on_run(*command, [options] {
    Margins& margins = options->judge.verdict.margins;
    if (!options->margin_file.empty()) margins = read_margins(options->margin_file);
    add_margins(options->margins, margins);
    run(*options);
  });
}

}  // namespace crossgait::apps
