// crossgait verdict: does a behaviour depend on the engine it was tried in?
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "crossgait/apps/env_options.h"
#include "crossgait/apps/verdict_options.h"
#include "crossgait/backends/registry.h"
#include "crossgait/parity/model_audit.h"
#include "crossgait/parity/verdict_report.h"
#include "crossgait/physics/error.h"

namespace crossgait::apps {
namespace {

struct Options {
  std::vector<std::string> engines;
  WorldOptions world;
  WalkOptions walk;
  SpreadOptions spread;
  std::string policy, config;
  bool explain = false;
  JsonOption json;
};

// The environment that the walk's options describe, or the file's.
EnvConfig environment(const Options& options) {
  if (!options.config.empty()) return load_env_config(options.config);
  EnvConfig c;
  c.robot = options.world.robot;
  c.terrain = options.world.terrain;
  c.terrain_seed = options.world.seed;
  c.friction = options.world.friction;
  c.physics_dt = options.world.physics_dt;
  c.control_dt = options.walk.timing.control_dt;
  c.policy_dt = c.control_dt;
  c.settle_seconds = options.walk.timing.settle_seconds;
  c.episode_seconds = options.walk.timing.seconds;
  c.gait = options.walk.gait;
  c.parameters = find_gait(c.gait).preferred;
  for (const std::string& setting : options.walk.settings) assign(c.parameters, setting);
  c.command = options.walk.make_command();
  c.validate("command line");
  return c;
}

Behaviour behaviour(const Options& options, const WorldSpec& spec, const std::string& engine) {
  if (options.policy.empty()) return walk_behaviour(options.world, options.walk, spec, options.spread.spread);
  EnvConfig config = environment(options);
  config.backend = engine;
  policy_factory(options.policy)(env_factory(config)()->interface());  // a bad one before long runs
  return policy_behaviour(config, policy_factory(options.policy), options.policy, options.spread.spread,
                          options.world.seed);
}

std::vector<std::string> two_engines(const std::vector<std::string>& asked) {
  std::vector<std::string> engines = asked;
  if (engines.empty() && available_engines().size() >= 2)
    engines = {available_engines().front(), available_engines().back()};
  if (engines.size() != 2 || engines[0] == engines[1])
    throw ConfigError("command line", "--engines", "two different engines",
                      fmt::format("{}", fmt::join(engines, ",")));
  return engines;
}

void run(const Options& options) {
  options.spread.verdict.validate();
  const std::vector<std::string> engines = two_engines(options.engines);
  const WorldSpec spec = options.world.make();
  // Before the long runs: names, and whether both engines hold the same machine at all.
  const auto world_a = make_backend(engines[0], spec), world_b = make_backend(engines[1], spec);
  const std::vector<AuditFinding> audit = audit_models(*world_a, *world_b);
  std::optional<EngineFamily> family;
  if (options.explain) family = find_family(find_engine(engines[0]), find_engine(engines[1]));
  const Behaviour what = behaviour(options, spec, engines[0]);
  const VerdictOptions& how = options.spread.verdict;
  std::string text;
  nlohmann::ordered_json json;
  {
    ProgressLine progress("judging");
    const Verdict verdict = reach_verdict(what, find_engine(engines[0]), find_engine(engines[1]), how,
                                          [&](double share) { progress.update(share); });
    text = fmt::format("{}\nModels: {}.\n", describe(verdict), describe(audit));
    json = to_json(verdict);
    json["models"] = to_json(audit);
  }
  if (family) {
    ProgressLine progress("explaining");
    const Attribution attribution = attribute(what, *family, {how.starts, how.confidence, how.workers},
                                              [&](double share) { progress.update(share); });
    text += "\n" + describe(attribution);
    json["attribution"] = to_json(attribution);
  }
  options.json.emit(text, json);
}

}  // namespace

void add_verdict_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "verdict", "Does a behaviour depend on the engine? The gap between two, in spreads within one");
  command->footer(
      "\nExamples:\n"
      "  crossgait verdict\n"
      "  crossgait verdict --explain\n"
      "  crossgait verdict --gait gallop --terrain rough --starts 24 --json verdict.json\n"
      "  crossgait verdict --policy policy.safetensors --config env.yaml\n"
      "docs/verdict.md has the rule.");
  auto options = std::make_shared<Options>();
  command
      ->add_option("--engines", options->engines,
                   "Two, comma-separated; the first and last that are built in")
      ->delimiter(',');
  options->world.add_to(*command);
  options->walk.add_to(*command);
  options->spread.add_to(*command);
  CLI::Option* policy =
      command
          ->add_option("--policy", options->policy,
                       "Judge a policy in the environment that the other options describe, not a walk")
          ->type_name("zero|random|FILE.safetensors|FILE.yaml");
  CLI::Option* config =
      command->add_option("--config", options->config, "The policy's environment as YAML")->needs(policy);
  for (const char* other : {"--robot", "--terrain", "--friction", "--physics-dt", "--gait", "--set",
                            "--speed", "--command", "--seconds", "--control-dt", "--settle"})
    config->excludes(command->get_option(other));
  command->add_flag("--explain", options->explain,
                    "Also say what the gap comes from, one factor of the contact at a time");
  options->json.add_to(*command);
  command->callback([options] { run(*options); });
}

}  // namespace crossgait::apps
