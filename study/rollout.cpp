#include "crossgait/study/rollout.h"

#include <thread>

#include "crossgait/backends/registry.h"

namespace crossgait {

std::size_t EpisodeOptions::default_workers() { return std::max(1U, std::thread::hardware_concurrency()); }

EnvFactory env_factory(const EnvConfig& config) {
  return [model = EnvModel::make(config), engine = find_engine(config.engine)] {
    return std::make_unique<AdaptiveGaitEnv>(model, engine);
  };
}

PolicyFactory policy_factory(const std::string& policy) {
  return [policy](const PolicyInterface& interface) { return make_policy(policy, interface); };
}

Rollout roll_out(const EnvConfig& config, const std::vector<std::string>& policies,
                 const EpisodeOptions& options, const Progress& progress) {
  Rollout rollout{config, options.seed, {}};
  const EnvFactory environments = env_factory(config);
  const double count = static_cast<double>(policies.size());
  for (const std::string& policy : policies) {
    const double done = static_cast<double>(rollout.policies.size());
    const Progress part =
        progress ? Progress([&](double share) { progress((done + share) / count); }) : Progress();
    PolicyEpisodes run{policy,
                       evaluate_policy(environments, policy_factory(policy), options.episodes, options.seed,
                                       options.workers, part),
                       {}};
    run.all = sum_up(run.episodes);
    rollout.policies.push_back(std::move(run));
  }
  return rollout;
}

Trace trace_episode(const EnvConfig& config, const std::string& policy, std::uint64_t seed) {
  const auto env = env_factory(config)();
  const auto own = policy_factory(policy)(env->interface());
  Trace trace;
  run_episode(*env, *own, derived_seed(seed, 0), [&trace](const AdaptiveGaitEnv& e) {
    trace.emplace_back(e.backend(), e.targets());
    trace.back().parameters = e.info().parameters;
    return true;
  });
  return trace;
}

Transfer transfer_policy(const EnvConfig& config, const std::string& policy,
                         const std::vector<std::string>& engines, const std::vector<std::string>& terrains,
                         const EpisodeOptions& options, const Progress& progress) {
  Transfer transfer{policy, options.seed, engines, terrains, {}};
  const double all = static_cast<double>(terrains.size() * engines.size());
  for (const std::string& terrain : terrains) {
    for (const std::string& engine : engines) {
      EnvConfig here = config;
      here.terrain = terrain;
      here.engine = engine;
      const EnvFactory environments = env_factory(here);
      const auto evaluate = [&](const std::string& which) {
        return sum_up(evaluate_policy(environments, policy_factory(which), options.episodes, options.seed,
                                      options.workers));
      };
      TransferCell cell{terrain, engine, evaluate(policy), {}};
      cell.baseline = policy == "zero" ? cell.policy : evaluate("zero");
      transfer.cells.push_back(std::move(cell));
      if (progress) progress(static_cast<double>(transfer.cells.size()) / all);
    }
  }
  return transfer;
}

}  // namespace crossgait
