// crossgait rollout: whole episodes of a policy in one engine.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crossgait/apps/env_options.h"
#include "crossgait/parity/table.h"
#include "crossgait/parity/trace.h"
#include "crossgait/physics/error.h"

namespace crossgait::apps {
namespace {

struct Options {
  EnvOptions env;
  std::vector<std::string> policies = {"zero"};
  bool baseline = false;
  EpisodeOptions runs;
  std::string trace;
  JsonOption json;
};

struct Run {
  std::string policy;
  std::vector<EpisodeSummary> episodes;
  Evaluation all;
};

std::string spread(const Evaluation::Spread& s, int digits) {
  return fmt::format("{:.{}f} +- {:.{}f}", s.mean, digits, s.deviation, digits);
}

// Rewards have any size: the guide's run to thousands of millions.
std::string reward(double value) { return fmt::format("{:.5g}", value); }

std::string table(const EnvConfig& config, const std::vector<Run>& runs) {
  std::vector<std::string> header{fmt::format("{} on {} in {}, {} episodes", config.gait, config.terrain,
                                              config.backend, runs.front().all.episodes)};
  for (const Run& run : runs) header.push_back(short_name(run.policy));
  Table table(header);
  const auto add = [&](const std::string& label, auto&& value) {
    std::vector<std::string> row{label};
    for (const Run& run : runs) row.push_back(value(run.all));
    table.add_row(row);
  };
  add("outcome", [](const Evaluation& e) { return outcome(e); });
  add("simulated time, s", [](const Evaluation& e) { return fmt::format("{:.1f}", e.simulated_seconds); });
  add("return per episode", [](const Evaluation& e) {
    return fmt::format("{} +- {}", reward(e.total_reward.mean), reward(e.total_reward.deviation));
  });
  for (std::size_t i = 0; i < config.reward.size(); ++i) {
    if (config.reward[i] == 0) continue;
    add(fmt::format("  {}", reward_terms()[i].name),
        [i](const Evaluation& e) { return reward(e.reward_terms[i]); });
  }
  add("distance, m", [](const Evaluation& e) { return spread(e.distance, 3); });
  add("mean speed, m/s", [](const Evaluation& e) { return spread(e.speed, 4); });
  add("RMS roll, deg", [](const Evaluation& e) { return fmt::format("{:.2f}", e.rms_roll_deg); });
  add("RMS pitch, deg", [](const Evaluation& e) { return fmt::format("{:.2f}", e.rms_pitch_deg); });
  add("slip of loaded feet, m", [](const Evaluation& e) { return fmt::format("{:.2f}", e.slip_m); });
  add("cost of transport", [](const Evaluation& e) { return fmt::format("{:.2f}", e.cost_of_transport); });
  add("IK targets clamped", [](const Evaluation& e) { return fmt::format("{}", e.ik_clamped); });
  return table.str();
}

// The first episode once more, watched.
void write_trace(const Options& options, const EnvConfig& config) {
  const auto env = env_factory(config)();
  const auto policy = policy_factory(options.policies.front())(env->interface());
  Trace trace;
  run_episode(*env, *policy, derived_seed(options.runs.seed, 0), [&](const AdaptiveGaitEnv& e) {
    trace.emplace_back(WalkSample{e.backend().state(), e.targets(), e.info().contacts, &e.info().parameters});
    return true;
  });
  write_trace_csv(env->backend().robot(), trace, options.trace);
}

void run(const Options& options) {
  const EnvConfig config = options.env.make();
  std::vector<std::string> policies = options.policies;
  if (options.baseline && std::find(policies.begin(), policies.end(), "zero") == policies.end())
    policies.emplace_back("zero");
  std::vector<Run> runs;
  ProgressLine progress("rolling out");
  for (const std::string& policy : policies) {
    Run run{policy, {}, {}};
    const double done = static_cast<double>(runs.size());
    run.episodes = evaluate_policy(env_factory(config), policy_factory(policy), options.runs.episodes,
                                   options.runs.seed, options.runs.workers, [&](double share) {
                                     progress.update((done + share) / static_cast<double>(policies.size()));
                                   });
    run.all = sum_up(run.episodes);
    runs.push_back(std::move(run));
  }
  if (!options.trace.empty()) write_trace(options, config);

  nlohmann::ordered_json json{{"backend", config.backend},
                              {"terrain", config.terrain},
                              {"gait", config.gait},
                              {"seed", options.runs.seed},
                              {"policies", nlohmann::ordered_json::array()}};
  for (const Run& run : runs) {
    nlohmann::ordered_json entry{{"policy", run.policy}, {"all", to_json(run.all)}};
    for (const EpisodeSummary& episode : run.episodes) entry["episodes"].push_back(to_json(episode));
    json["policies"].push_back(entry);
  }
  options.json.emit(table(config, runs), json);
}

}  // namespace

void add_rollout_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "rollout", "Whole episodes of a policy in one engine: return, reward terms, falls");
  command->footer(
      "\nExamples:\n"
      "  crossgait rollout\n"
      "  crossgait rollout --policy random --baseline --terrain rough --engine bullet\n"
      "  crossgait rollout --policy policy.safetensors --config env.yaml --episodes 10 --json -");
  auto options = std::make_shared<Options>();
  command
      ->add_option("--policy", options->policies,
                   "zero (the plain gait), random, or a file (docs/policies.md); comma-separated for several")
      ->type_name("zero|random|FILE.safetensors|FILE.yaml")
      ->delimiter(',')
      ->capture_default_str();
  command->add_flag("--baseline", options->baseline, "Show the zero policy beside it");
  options->runs.add_to(*command);
  command
      ->add_option("--trace", options->trace,
                   "Write state, targets, contacts and parameters of the first policy's first episode as CSV")
      ->type_name("FILE.csv");
  options->env.add_to(*command);
  options->json.add_to(*command);
  command->callback([options] { run(*options); });
}

}  // namespace crossgait::apps
