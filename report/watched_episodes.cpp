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
      columns.push_back({fmt::format("{}{}", kRewardColumn, reward_terms()[i].name), {}});
    }
  }

  std::vector<std::size_t> indices;
  std::vector<RecordedRun::Column> columns;  // of these, without a step
};

}  // namespace

Motion watch_episodes(const std::vector<WatchedEpisode>& episodes, std::uint64_t seed) {
  Motion motion;
  for (const WatchedEpisode& episode : episodes) {
    const CountedTerms terms(episode.environment.config);
    TraceRecorder recorder(kMaxPageSteps);
    RecordedRun run{episode.name, "", {}, terms.columns};
    watch_episode(episode.environment, episode.policy, seed, [&](const QuadrupedEnv& env) {
      if (run.engine.empty())
        run.engine = fmt::format("{} {}", env.engine().info.library, env.engine().info.version);
      if (motion.robot == nullptr) {
        // Of the world that the episode drew.
        motion.robot = env.world().spec().robot;
        motion.terrain = env.world().spec().terrain;
      }
      for (std::size_t i = 0; i < terms.indices.size(); ++i)
        run.columns[i].values.push_back(env.info().reward_terms[terms.indices[i]]);
      recorder.add(TraceSample(env.world(), env.targets()));
    });
    run.samples = recorder.take();
    if (!run.samples.empty()) motion.runs.push_back(std::move(run));
  }
  return motion;
}

}  // namespace crossgait
