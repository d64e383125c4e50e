// crossgait score: how well policies do what they are asked, each in each engine.
#include "diagnosis/import_table.h"
#include "diagnosis/policy_score.h"
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/env_options.h"
#include "backends/registry.h"
#include "policy/bundled_policies.h"

namespace crossgait::apps {
namespace {

struct ScoreCommand {
  std::vector<std::string> policies, engines;
  std::string env, trained_in;
  PolicyScoreOptions how;
  JsonOption json;
};

// A policy that was imported was trained elsewhere; of others the environment says where.
std::string trained_in(const ScoreCommand& options, const std::string& policy, const EnvConfig& environment) {
  if (!options.trained_in.empty()) return options.trained_in;
  return is_imported(policy) || !options.env.empty() ? "" : environment.engine;
}

ScoredPolicy read(const ScoreCommand& options, const std::string& policy) {
  const EnvConfig config = environment_of(options.env, policy);
  if (config.action != ActionKind::kJoints)
    throw ConfigError(config.source, "action", "joints: what a score asks for is commanded to them", "gait");
  return {short_name(policy), trained_in(options, policy, config), load_with_warnings(config),
          read_relabelled_policy(policy)};
}

void run(const ScoreCommand& options) {
  const std::vector<std::string> engines = options.engines.empty() ? available_engines() : options.engines;
  for (const std::string& engine : engines) static_cast<void>(find_engine(engine));
  std::vector<ScoredPolicy> policies;
  nlohmann::json environments = nlohmann::json::array(), names = nlohmann::json::array();
  for (const std::string& policy : options.policies) {
    policies.push_back(read(options, policy));
    environments.push_back(to_yaml(policies.back().environment.config));
    names.push_back(policies.back().name);
  }
  const Provenance provenance = options.json.provenance(
      {{{"behaviour", {{"environments", environments}}}, {"policies", names}, {"seed", options.how.seed}},
       engines,
       {{"--engines", engines}}});
  ProgressLine progress("scoring");
  const std::vector<PolicyCell> cells =
      score_policies(policies, engines, options.how, [&](double share) { progress.update(share); });
  options.json.emit(describe(cells), to_json(cells, options.how), provenance);
}

}  // namespace

void add_score_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command =
      program.add_subcommand("score", "How well policies do what they are asked, each in each engine");
  command->footer(
      "\nWalks each straight ahead, turning and standing, from several starts; the score is that of "
      "`diagnose` "
      "(docs/diagnosis.md).\n\nExamples:\n"
      "  crossgait score serial_joints --engines mujoco,bullet\n"
      "  crossgait score runs/3/policy.safetensors --env runs/3/environment.yaml --json -");
  auto options = std::make_shared<ScoreCommand>();
  options->how.workers = EpisodeOptions::default_workers();
  command
      ->add_option("policies", options->policies,
                   "Folders, names of policies that come with Crossgait, or files with --env")
      ->type_name("CHECKPOINT")
      ->required();
  command->add_option("--engines", options->engines, "Comma-separated; all that are built in by default")
      ->delimiter(',');
  command->add_option("--env", options->env, "Their environment; each folder's own by default")
      ->type_name("FILE.yaml");
  command
      ->add_option("--trained-in", options->trained_in,
                   "The engine that they were trained in, which results repeat; by default what the "
                   "environment of a policy that was not imported says")
      ->type_name("ENGINE");
  command->add_option("--starts", options->how.starts, "Of every command: other headings and tilts")
      ->check(CLI::Range(2, 1000))
      ->capture_default_str();
  command
      ->add_option("--seconds", options->how.seconds,
                   "Simulated length of a walk, s, of which the first second does not count")
      ->check(CLI::Range(1.5, 1000.0))
      ->capture_default_str();
  add_seed_option(*command, "--seed", options->how.seed, "Seed of the starts")->capture_default_str();
  add_workers_option(*command, options->how.workers);
  options->json.add_to(*command, invocation);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
