#include "study/rollout.h"

#include <thread>

#include "backends/registry.h"

namespace crossgait {

std::size_t EpisodeOptions::default_workers() { return std::max(1U, std::thread::hardware_concurrency()); }

EnvFactory env_factory(const LoadedEnv& environment) {
  return [model = EnvModel::make(environment), engine = find_engine(environment.config.engine)] {
    return std::make_unique<QuadrupedEnv>(model, engine);
  };
}

NamedPolicy find_policy(const std::string& text) { return {text, load_policy(text)}; }

Rollout roll_out(const LoadedEnv& environment, const std::vector<std::string>& policies,
                 const EpisodeOptions& options, const Progress& progress) {
  std::vector<NamedPolicy> named;
  for (const std::string& policy : policies) named.push_back(find_policy(policy));
  return roll_out(environment, named, options, progress);
}

Rollout roll_out(const LoadedEnv& environment, std::span<const NamedPolicy> policies,
                 const EpisodeOptions& options, const Progress& progress) {
  Rollout rollout{environment.config, options.seed, {}};
  const EnvFactory environments = env_factory(environment);
  const double count = static_cast<double>(policies.size());
  for (const NamedPolicy& policy : policies) {
    const double done = static_cast<double>(rollout.policies.size());
    rollout.interrupted = interrupted_at(progress, done / count);
    if (rollout.interrupted) break;
    PolicyEpisodes run{policy.name,
                       evaluate_policy(environments, policy.make, options.episodes, options.seed,
                                       options.workers, part_of(progress, done / count, (done + 1) / count)),
                       {}};
    rollout.interrupted = run.episodes.size() < options.episodes;
    if (run.episodes.empty()) break;
    run.all = sum_up(run.episodes);
    rollout.policies.push_back(std::move(run));
    if (rollout.interrupted) break;
  }
  return rollout;
}

EpisodeSummary watch_episode(const LoadedEnv& environment, const NamedPolicy& policy, std::uint64_t seed,
                             const std::function<void(const QuadrupedEnv&)>& observer, std::size_t episode) {
  const auto env = env_factory(environment)();
  const auto own = policy.make(env->interface());
  return run_episode(*env, *own, derived_seed(seed, episode), [&observer](const QuadrupedEnv& e) {
    observer(e);
    return true;
  });
}

void record_episode(const LoadedEnv& environment, const NamedPolicy& policy, std::uint64_t seed,
                    TraceSink& sink) {
  watch_episode(environment, policy, seed,
                [&sink](const QuadrupedEnv& env) { sink.add(TraceSample(env.world(), env.targets())); });
}

Transfer transfer_policy(const LoadedEnv& environment, const NamedPolicy& policy,
                         const std::vector<std::string>& engines, const std::vector<std::string>& terrains,
                         const EpisodeOptions& options, const Progress& progress) {
  Transfer transfer{policy.name, options.seed, engines, terrains, {}};
  const double all = static_cast<double>(terrains.size() * engines.size());
  for (const std::string& terrain : terrains) {
    EnvConfig on_terrain = environment.config;
    on_terrain.terrain = terrain;
    LoadedEnv here = environment.with(on_terrain);
    for (const std::string& engine : engines) {
      here.config.engine = engine;
      const EnvFactory environments = env_factory(here);
      const auto done = static_cast<double>(transfer.cells.size());
      transfer.interrupted = interrupted_at(progress, done / all);
      if (transfer.interrupted) return transfer;
      const auto evaluate = [&](const NamedPolicy& which, double from, double to) {
        const auto episodes =
            evaluate_policy(environments, which.make, options.episodes, options.seed, options.workers,
                            part_of(progress, (done + from) / all, (done + to) / all));
        transfer.interrupted = episodes.size() < options.episodes;
        return sum_up(episodes);
      };
      const bool alone = policy.name == "zero";  // then it is its own baseline
      TransferCell cell{terrain, engine, evaluate(policy, 0, alone ? 1 : 0.5), {}};
      if (transfer.interrupted) return transfer;
      cell.baseline = alone ? cell.policy : evaluate(find_policy("zero"), 0.5, 1);
      if (transfer.interrupted) return transfer;
      transfer.cells.push_back(std::move(cell));
    }
  }
  return transfer;
}

}  // namespace crossgait
