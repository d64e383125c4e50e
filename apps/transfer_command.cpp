// crossgait transfer: one policy in every engine on every ground.
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

struct TransferCommand {
  EnvOptions env;
  std::string policy = "zero";
  std::vector<std::string> engines, terrains = {"flat", "rough", "waves"};
  EpisodeOptions runs;
  PageOption page;
  JsonOption json;
};

ReportPage page_of(const Transfer& transfer, const LoadedEnv& environment, const std::string& policy) {
  EnvConfig first = environment.config;
  first.terrain = transfer.terrains.front();
  LoadedEnv here = environment.with(first);
  const NamedPolicy watched = find_policy(policy);
  std::vector<WatchedEpisode> episodes;
  for (const std::string& engine : transfer.engines) {
    here.config.engine = engine;
    episodes.push_back({engine, here, watched});
  }
  ReportPage page;
  page.title = fmt::format("{} in {}", short_name(policy), counted(transfer.engines.size(), "engine"));
  page.tables.push_back({table(transfer)});
  page.motions.push_back(watch_episodes(episodes, transfer.seed));
  page.sentences.push_back(
      fmt::format("Replayed: the policy's first episode on {} in every engine.", transfer.terrains.front()));
  return page;
}

void run(const TransferCommand& options) {
  const std::vector<std::string> engines = engines_or_all(options.engines);
  const LoadedEnv environment = options.env.make(options.policy);
  options.page.check(environment.config);
  nlohmann::json subject = policy_subject(environment, {options.policy}, options.runs.seed);
  subject["terrains"] = options.terrains;
  const Provenance provenance = options.json.provenance({subject, engines, {{"--engines", engines}}});
  note_cost(engines, environment, environment.config.episode_seconds,
            options.terrains.size() * options.runs.episodes, "its episodes");
  ProgressLine progress("transferring");
  const Transfer transfer = transfer_policy(environment, options.policy, engines, options.terrains,
                                            options.runs, [&](double share) { progress.update(share); });
  if (options.page.asked()) options.page.write(page_of(transfer, environment, options.policy), provenance);
  options.json.emit(describe(transfer), to_json(transfer), provenance);
  if (transfer.interrupted) {
    throw EndedEarly(fmt::format("{} of {} are finished, and written as asked", transfer.cells.size(),
                                 counted(options.terrains.size() * engines.size(), "cell")));
  }
}

}  // namespace

void add_transfer_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command =
      program.add_subcommand("transfer", "One policy in every engine on every ground: does it carry over?");
  command->footer(
      "\nExamples:\n"
      "  crossgait transfer --policy policy.safetensors --config env.yaml\n"
      "  crossgait transfer --terrains flat rough stairs:rise=.005,run=.1 --engines mujoco,bullet --episodes "
      "5 --json -");
  auto options = std::make_shared<TransferCommand>();
  command->add_option("--policy", options->policy, "zero, random, or a file (docs/policies.md)")
      ->type_name("zero|random|FILE.safetensors|FILE.yaml")
      ->capture_default_str();
  command->add_option("--engines", options->engines, "Comma-separated; all that are built in by default")
      ->delimiter(',');
  command
      ->add_option("--terrains", options->terrains,
                   "Separated by blanks or semicolons (a terrain's own text has commas)")
      ->delimiter(';')
      ->capture_default_str();
  add_episode_options(*command, options->runs);
  options->page.add_to(*command, "Write a page that replays an episode in every engine, as one HTML file");
  options->env.add_to(*command, EnvScope::kManyWorlds);
  options->json.add_to(*command, invocation);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
