#include "report/watched_episodes.h"

#include <cmath>

#include <fmt/format.h>

#include "env/reward.h"
#include "parity/answer.h"

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

Motion watch_episodes(const std::vector<WatchedEpisode>& episodes, std::uint64_t seed, double sample_time) {
  Motion motion;
  for (const WatchedEpisode& episode : episodes) {
    const CountedTerms terms(episode.environment.config);
    TraceRecorder recorder(kMaxPageSteps);
    RecordedRun run{episode.name, "", {}, terms.columns};
    double sampled = -HUGE_VAL;
    const auto observe = [&](const QuadrupedEnv& env) {
      if (run.engine.empty())
        run.engine = fmt::format("{} {}", env.engine().info.library, env.engine().info.version);
      if (motion.robot == nullptr) {
        // Of the world that the episode drew.
        motion.robot = env.world().spec().robot;
        motion.terrain = env.world().spec().terrain;
      }
      const double time = env.world().state().time;
      // A rounded sum of steps may be a little short of it.
      if (time - sampled < sample_time * (1 - 1e-6)) return;
      sampled = time;
      for (std::size_t i = 0; i < terms.indices.size(); ++i)
        run.columns[i].values.push_back(env.info().reward_terms[terms.indices[i]]);
      recorder.add(TraceSample(env.world(), env.targets()));
    };
    const MotionSummary summary =
        watch_episode(episode.environment, episode.policy, seed, observe, episode.number).motion;
    run.samples = recorder.take();
    run.outcome = outcome_phrase(summary);
    run.outcome_at_s = summary.first_at_s[static_cast<std::size_t>(summary.outcome)];
    if (!run.samples.empty()) motion.runs.push_back(std::move(run));
  }
  return motion;
}

}  // namespace crossgait
