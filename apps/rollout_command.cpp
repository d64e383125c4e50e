// crossgait rollout: whole episodes of a policy in one engine.
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/env_options.h"
#include "apps/interruption.h"
#include "apps/page_option.h"
#include "apps/step_cost.h"
#include "physics/core/table.h"
#include "report/watched_episodes.h"
#include "study/rollout.h"

namespace crossgait::apps {
namespace {

struct RolloutCommand {
  EnvOptions env;
  std::vector<std::string> policies = {"zero"};
  bool baseline = false;
  EpisodeOptions runs;
  std::string trace;
  PageOption page;
  JsonOption json;
};

std::string episodes_done(const Rollout& rollout, std::size_t asked) {
  std::size_t done = 0;
  for (const PolicyEpisodes& run : rollout.policies) done += run.episodes.size();
  return fmt::format("{} of {} are finished, and written as asked", done, counted(asked, "episode"));
}

ReportPage page_of(const Rollout& rollout, const LoadedEnv& environment,
                   const std::vector<NamedPolicy>& policies) {
  std::vector<WatchedEpisode> episodes;
  for (const NamedPolicy& policy : policies)
    episodes.push_back({short_name(policy.name), environment, policy});
  ReportPage page;
  page.tables.push_back({table(rollout)});
  page.title = page.tables.front().table.rows().front().front();
  page.motions.push_back(watch_episodes(episodes, rollout.seed));
  page.summary = summary(rollout);
  page.sentences.push_back(fmt::format("Replayed: the first of {}, with what every policy step earned.",
                                       counted(rollout.policies.front().all.episodes, "episode")));
  return page;
}

void run(const RolloutCommand& options) {
  const LoadedEnv environment = options.env.make(options.policies.empty() ? "" : options.policies.front());
  const EnvConfig& config = environment.config;
  options.page.check(config);
  std::vector<std::string> names = options.policies;
  if (options.baseline && std::find(names.begin(), names.end(), "zero") == names.end())
    names.emplace_back("zero");
  const Provenance provenance =
      options.json.provenance({policy_subject(environment, names, options.runs.seed),
                               {config.engine},
                               {{"--engine", {config.engine}}}});
  std::vector<NamedPolicy> policies;  // read once, whoever runs them
  for (const std::string& name : names) policies.push_back(find_policy(name));
  note_cost({config.engine}, environment, config.episode_seconds, policies.size() * options.runs.episodes,
            "these episodes");
  ProgressLine progress("rolling out");
  const Rollout rollout =
      roll_out(environment, policies, options.runs, [&](double share) { progress.update(share); });
  // Made anew, and that of an interrupted rollout too, if its first episode is among those that are done.
  if (!options.trace.empty() && !rollout.policies.empty()) {
    TraceWriter trace(environment.robot, options.trace);
    record_episode(environment, policies.front(), options.runs.seed, trace);
    trace.finish();
  }
  if (options.page.asked() && !rollout.policies.empty())
    options.page.write(page_of(rollout, environment, policies), provenance);
  options.json.emit(describe(rollout), to_json(rollout), provenance);
  print_notes(notes_on(rollout));
  if (rollout.interrupted) throw EndedEarly(episodes_done(rollout, policies.size() * options.runs.episodes));
}

}  // namespace

void add_rollout_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command = program.add_subcommand(
      "rollout", "Whole episodes of a policy in one engine: return, reward terms, falls");
  command->footer(
      "\nExamples:\n"
      "  crossgait rollout\n"
      "  crossgait rollout --policy random --baseline --terrain rough --engine bullet --report rollout.html\n"
      "  crossgait rollout --policy policy.safetensors --config env.yaml --episodes 10 --json -");
  auto options = std::make_shared<RolloutCommand>();
  command
      ->add_option("--policy", options->policies,
                   "zero (the plain gait), random, or a file (docs/policies.md); comma-separated for several")
      ->type_name("zero|random|FILE.safetensors|FILE.yaml")
      ->delimiter(',')
      ->capture_default_str();
  command->add_flag("--baseline", options->baseline, "Show the zero policy beside it");
  add_episode_options(*command, options->runs);
  add_output_option(
      *command, "--trace", options->trace,
      "Write state, targets, contacts and parameters of the first policy's first episode as CSV");
  options->page.add_to(*command, "Write a page that replays every policy's first episode, as one HTML file");
  options->env.add_to(*command);
  options->json.add_to(*command, invocation);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
