#include "apps/scored_policies.h"

#include <algorithm>

#include "diagnosis/import_table.h"
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "apps/checkpoint.h"
#include "apps/env_options.h"
#include "apps/step_cost.h"
#include "backends/registry.h"
#include "policy/bundled_policies.h"

namespace crossgait::apps {
namespace {

/// A folder's or a file's own name, or all that was given where two have the same.
std::string name_of(const std::string& policy, const std::vector<std::string>& all) {
  const std::string name = short_name(policy);
  const auto same = std::count_if(all.begin(), all.end(),
                                  [&](const std::string& other) { return short_name(other) == name; });
  return same > 1 ? policy : name;
}

/// The engines that were said by policy, and the one of all others.
class Homes {
 public:
  Homes(const std::vector<std::string>& said, const std::vector<std::string>& policies) {
    for (const std::string& item : said) {
      const std::size_t equals = item.rfind('=');
      const bool of_one = equals != std::string::npos;
      const std::string engine = of_one ? item.substr(equals + 1) : item;
      if (engine.empty() || (!of_one && !of_all_.empty()))
        throw ConfigError("command line", "--trained-in", "ENGINE once, or POLICY=ENGINE for each",
                          fmt::format("'{}'", fmt::join(said, ",")));
      if (of_one) {
        set(item.substr(0, equals), engine, policies);
      } else {
        of_all_ = engine;
      }
    }
  }

  std::string of(const std::string& policy) const {
    const auto found = by_policy_.find(policy);
    return found == by_policy_.end() ? of_all_ : found->second;
  }

 private:
  void set(const std::string& policy, const std::string& engine, const std::vector<std::string>& policies) {
    const auto is_it = [&](const std::string& given) {
      return given == policy || name_of(given, policies) == policy;
    };
    const auto found = std::find_if(policies.begin(), policies.end(), is_it);
    if (found == policies.end())
      throw ConfigError("command line", "--trained-in",
                        fmt::format("one of the policies: {}", fmt::join(policies, ", ")),
                        fmt::format("'{}'", policy));
    by_policy_[*found] = engine;
  }

  std::string of_all_;
  std::map<std::string, std::string> by_policy_;
};

// A policy that was imported was trained elsewhere; of others its training says where, or the environment.
std::string trained_in(const ScoredPoliciesOptions& options, const Homes& homes, const std::string& policy,
                       const EnvConfig& environment) {
  if (std::string said = homes.of(policy); !said.empty()) return said;
  if (is_imported(policy) || !options.env.empty()) return "";
  const std::vector<std::string> engines = engines_of_training(policy);
  return engines.empty() ? environment.engine : fmt::format("{}", fmt::join(engines, " and "));
}

ScoredPolicy read(const ScoredPoliciesOptions& options, const Homes& homes, const std::string& policy) {
  const EnvConfig config = environment_of(options.env, policy);
  if (config.action != ActionKind::kJoints)
    throw ConfigError(config.source, "action", "joints: what a score asks for is commanded to them", "gait");
  return {name_of(policy, options.policies), trained_in(options, homes, policy, config),
          load_with_warnings(config),
          is_checkpoint(policy) ? read_checkpoint(policy, config.source, options.agent)
                                : read_relabelled_policy(policy)};
}

}  // namespace

CLI::Option* ScoredPoliciesOptions::add_to(CLI::App& command, Invocation& invocation) {
  how.workers = EpisodeOptions::default_workers();
  CLI::Option* which = command
                           .add_option("policies", policies,
                                       "Folders of trainings and imports, names of policies that come with "
                                       "Crossgait, or with --env files: bundles, descriptions, "
                                       "and what trainings write (checkpoints of rsl_rl, TorchScript, ONNX)")
                           ->type_name("CHECKPOINT");
  command.add_option("--engines", engines, "Comma-separated; all that are built in by default")
      ->delimiter(',');
  command.add_option("--env", env, "Their environment; each folder's own by default")->type_name("FILE.yaml");
  command
      .add_option(
          "--agent", agent,
          "The agent.yaml of checkpoints of rsl_rl; by default the one beside each, or in `params` there")
      ->type_name("FILE.yaml");
  add_trust_option(command);
  command
      .add_option("--trained-in", trained_in,
                  "The engine that they were trained in, which results repeat: of all, or POLICY=ENGINE, "
                  "comma-separated; by default what the training or the environment of a policy that was not "
                  "imported says")
      ->delimiter(',')
      ->type_name("[POLICY=]ENGINE");
  command.add_option("--starts", how.starts, "Of every command: other headings and tilts")
      ->check(CLI::Range(2, 1000))
      ->capture_default_str();
  command
      .add_option("--seconds", how.seconds,
                  "Simulated length of a walk, s, of which the first second does not count")
      ->check(CLI::Range(1.5, 1000.0))
      ->capture_default_str();
  add_seed_option(command, "--seed", how.seed, "Seed of the starts")->capture_default_str();
  add_workers_option(command, how.workers);
  json.add_to(command, invocation);
  return which;
}

ScoredPolicies read_scored(const ScoredPoliciesOptions& options) {
  ScoredPolicies scored;
  scored.engines = engines_or_all(options.engines);
  for (const std::string& engine : scored.engines) static_cast<void>(find_engine(engine));
  const Homes homes(options.trained_in, options.policies);
  for (const std::string& policy : options.policies) scored.policies.push_back(read(options, homes, policy));
  return scored;
}

void note_provenance(const ScoredPoliciesOptions& options, ScoredPolicies& scored) {
  nlohmann::json environments = nlohmann::json::array(), names = nlohmann::json::array();
  for (const ScoredPolicy& policy : scored.policies) {
    environments.push_back(to_yaml(policy.environment.config));
    names.push_back(policy.name);
  }
  scored.provenance = options.json.provenance(
      {{{"behaviour", {{"environments", environments}}}, {"policies", names}, {"seed", options.how.seed}},
       scored.engines,
       {{"--engines", scored.engines}}});
}

ScoredPolicies score_them(ScoredPolicies scored, const PolicyScoreOptions& how) {
  for (const ScoredPolicy& policy : scored.policies) {
    note_cost(scored.engines, policy.environment, how.seconds,
              how.starts * walk_commands(policy.environment.config).size(),
              fmt::format("the walks of {}", policy.name));
  }
  ProgressLine progress("scoring");
  scored.cells =
      score_policies(scored.policies, scored.engines, how, [&](double share) { progress.update(share); });
  return scored;
}

ScoredPolicies score_them(const ScoredPoliciesOptions& options) {
  ScoredPolicies scored = read_scored(options);
  note_provenance(options, scored);
  return score_them(std::move(scored), options.how);
}

}  // namespace crossgait::apps
