#include "study/policy_walk.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "physics/robot/hips.h"

namespace crossgait {
namespace {

struct Episode {
  WalkRun run;
  Trace trace;
};

void check_each_once(const std::vector<std::string>& engines) {
  std::vector<std::string> sorted = engines;
  std::sort(sorted.begin(), sorted.end());
  if (engines.empty() || std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
    throw ConfigError("compare", "engines", "each engine once", fmt::format("{}", fmt::join(engines, ",")));
}

Episode record(LoadedEnv environment, const NamedPolicy& policy, const std::string& engine,
               std::uint64_t seed, const Progress& progress, TraceSink* sink) {
  environment.config.engine = engine;
  const auto env = env_factory(environment)();
  const auto own = policy.make(env->interface());
  TraceRecorder recorder;
  int steps = 0;
  const auto observe = [&](const QuadrupedEnv& e) {
    const TraceSample sample(e.world(), e.targets());
    recorder.add(sample);
    if (sink != nullptr) sink->add(sample);
    if (progress) progress(static_cast<double>(++steps) / e.model().max_steps);
    return true;
  };
  const EpisodeSummary summary = run_episode(*env, *own, derived_seed(seed, 0), observe);
  const std::string name = short_name(policy.name);
  return {{env->world().info(), env->world().spec().terrain.name(), name, env->world().spec().contact,
           summary.motion, false},
          recorder.take()};
}

PairDifference compared(const Episode& a, const Episode& b, const DivergenceTolerances& tolerances,
                        double leg_length) {
  PairDifference pair = pair_of(a.run.engine, b.run.engine, tolerances, leg_length);
  compare_traces(a.trace, b.trace, pair);
  return pair;
}

}  // namespace

Comparison compare_episodes(const LoadedEnv& environment, const NamedPolicy& policy,
                            const std::vector<std::string>& engines, std::uint64_t seed,
                            const DivergenceTolerances& tolerances, const Progress& progress,
                            const TraceSinks& sinks) {
  check_each_once(engines);
  Comparison result;
  result.leg_length_m = leg_length(*environment.robot);
  std::vector<Episode> episodes;
  const auto count = static_cast<double>(engines.size());
  try {
    for (std::size_t i = 0; i < engines.size(); ++i) {
      const auto part = static_cast<double>(i);
      episodes.push_back(record(environment, policy, engines[i], seed,
                                part_of(progress, part / count, (part + 1) / count),
                                sinks.empty() ? nullptr : sinks.at(i)));
    }
  } catch (const Interrupted&) {
    result.interrupted = true;
  }
  for (std::size_t i = 0; i < episodes.size(); ++i) {
    result.runs.push_back(episodes[i].run);
    for (std::size_t k = i + 1; k < episodes.size(); ++k)
      result.pairs.push_back(compared(episodes[i], episodes[k], tolerances, result.leg_length_m));
  }
  return result;
}

}  // namespace crossgait
