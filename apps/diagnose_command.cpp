// crossgait diagnose: why a policy does not do here what it was trained for.
#include "diagnosis/diagnosis.h"
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/diagnose_page.h"
#include "apps/env_options.h"
#include "apps/page_option.h"
#include "physics/core/atomic_file.h"
#include "policy/bundled_policies.h"

namespace crossgait::apps {
namespace {

constexpr int kCauseFound = 3, kAbstained = 4;

struct DiagnoseCommand {
  std::string folder, policy, env, engine, write, home_engine;
  DiagnosisOptions how;
  bool no_search = false;
  PageOption page;
  JsonOption json;
};

void run(const DiagnoseCommand& options) {
  if (options.folder.empty() == options.policy.empty())
    throw ConfigError("command line", "NAME or --policy", "one of them",
                      options.folder.empty() ? "neither" : "both");
  const std::string policy = options.folder.empty() ? options.policy : options.folder;
  EnvConfig config = environment_of(options.env, policy);
  if (!options.engine.empty()) config.engine = options.engine;
  const LoadedEnv environment = load_with_warnings(config);
  options.page.check();
  DiagnosisOptions how = options.how;
  how.search = !options.no_search;
  if (!options.home_engine.empty()) how.home_engine = options.home_engine;
  const Provenance provenance =
      options.json.provenance({{{"behaviour", {{"environment", to_yaml(environment.config)}}},
                                {"policies", {short_name(policy)}},
                                {"seed", how.seed}},
                               {environment.config.engine},
                               {{"--engine", {environment.config.engine}}}});
  ProgressLine progress("diagnosing");
  const Diagnosis found = diagnose(environment, policy, how, [&](double share) { progress.update(share); });
  if (!options.write.empty()) write_file_atomically(options.write, to_yaml(found.environment));
  if (options.page.asked())
    options.page.write(diagnose_page(found, environment, policy, how.seed), provenance);
  options.json.emit(describe(found), to_json(found, options.write), provenance);
  if (found.cause) throw RequirementMissed(kCauseFound, fmt::format("the cause: {}", name(*found.cause)));
  if (!found.healthy)
    throw RequirementMissed(kAbstained, "it does not do what it is asked; no cause is named");
}

}  // namespace

void add_diagnose_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command = program.add_subcommand(
      "diagnose", "Why a policy does not do here what it was trained for: contract, physics, or itself");
  command->footer(
      "\nWalks it straight ahead, turning and standing; where it does not do what it is asked, with every "
      "field of its\nenvironment changed, one at a time and then two, until it does (docs/diagnosis.md).\n"
      "Exit codes beside those of all commands: 3 a cause is named, 4 it does not do what it is asked and "
      "none is.\n\nExamples:\n"
      "  crossgait diagnose go2_walk --write go2_walks.yaml --report go2.html\n"
      "  crossgait diagnose --policy policy.safetensors --env env.yaml --home-engine bullet");
  auto options = std::make_shared<DiagnoseCommand>();
  options->how.workers = EpisodeOptions::default_workers();
  command
      ->add_option(
          "folder", options->folder,
          "A folder that `crossgait import` wrote, or the name of a policy that comes with Crossgait")
      ->type_name("NAME");
  command->add_option("--policy", options->policy, "A policy's file, in the place of a folder")
      ->type_name("FILE.safetensors|FILE.yaml");
  command->add_option("--env", options->env, "Its environment; the folder's by default")
      ->type_name("FILE.yaml");
  command->add_option("--engine", options->engine, "In which it does not walk; the environment's by default");
  command->add_option("--home-engine", options->home_engine,
                      "In which it was trained: tells the physics from the policy where nothing else helps");
  command->add_flag("--no-search", options->no_search, "Only see whether it does what it is asked");
  add_seed_option(*command, "--seed", options->how.seed, "Seed of the starts")->capture_default_str();
  add_workers_option(*command, options->how.workers);
  command
      ->add_option("--minutes", options->how.minutes,
                   "After which no further changes of two fields are tried; 0: no limit")
      ->check(CLI::Range(0.0, 1e4))
      ->capture_default_str();
  add_output_option(*command, "--write", options->write,
                    "Write the environment with the first of the ranking, as YAML");
  options->page.add_to(
      *command, "Write a page with the changes, their effects and every command replayed, as one HTML file");
  options->json.add_to(*command, invocation);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
