#include "report/watched_episodes.h"

#include <fmt/format.h>

#include "env/reward.h"
#include "study/rollout.h"

namespace crossgait {
namespace {

/// The terms that count in an environment.
struct CountedTerms {
  explicit CountedTerms(const EnvConfig& config) {
    for (std::size_t i = 0; i < config.reward.size(); ++i) {
      if (config.reward[i] == 0) continue;
      indices.push_back(i);
      columns.push_back(fmt::format("{}{}", kRewardColumn, reward_terms()[i].name));
    }
  }

  std::vector<std::size_t> indices;
  std::vector<std::string> columns;
};

}  // namespace

Motion watch_episodes(const std::vector<WatchedEpisode>& episodes, std::uint64_t seed) {
  Motion motion;
  for (const WatchedEpisode& episode : episodes) {
    const CountedTerms terms(episode.environment.config);
    std::optional<RunRecorder> recorder;
    std::string engine;
    std::vector<double> earned;
    watch_episode(episode.environment, episode.policy, seed, [&](const QuadrupedEnv& env) {
      if (!recorder) {
        // Of the world that the episode drew.
        const WorldSpec& world = env.world().spec();
        recorder.emplace(world.robot, terms.columns);
        engine = fmt::format("{} {}", env.engine().info.library, env.engine().info.version);
        if (motion.robot == nullptr) {
          motion.robot = world.robot;
          motion.terrain = world.terrain;
        }
      }
      earned.clear();
      for (const std::size_t i : terms.indices) earned.push_back(env.info().reward_terms[i]);
      recorder->add(trace_sample(env), earned);
    });
    if (recorder) motion.runs.push_back({episode.name, engine, recorder->take(episode.name)});
  }
  return motion;
}

}  // namespace crossgait
