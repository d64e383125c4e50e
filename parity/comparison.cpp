#include "parity/comparison.h"

#include <optional>

namespace crossgait {
namespace {

struct Runner {
  PhysicsBackend& world;
  Walk walk;
  std::optional<TraceSample> sample;  ///< of the step that all are in; none once its walk is over
};

void advance(std::vector<Runner>& runners, const TraceSinks& sinks) {
  for (std::size_t i = 0; i < runners.size(); ++i) {
    Runner& r = runners[i];
    r.sample.reset();
    if (!r.walk.advance()) continue;
    const WalkSample now = r.walk.sample();
    r.sample.emplace(now.world, now.targets);
    if (!sinks.empty()) sinks.at(i)->add(*r.sample);
  }
}

void compare(const std::vector<Runner>& runners, std::vector<PairDifference>& pairs) {
  std::size_t pair = 0;
  for (std::size_t i = 0; i < runners.size(); ++i) {
    for (std::size_t k = i + 1; k < runners.size(); ++k, ++pair) {
      if (runners[i].sample && runners[k].sample)
        compare_samples(*runners[i].sample, *runners[k].sample, pairs[pair]);
    }
  }
}

std::vector<PairDifference> pairs_of(const std::vector<Runner>& runners,
                                     const DivergenceTolerances& tolerances) {
  std::vector<PairDifference> pairs;
  for (std::size_t i = 0; i < runners.size(); ++i) {
    for (std::size_t k = i + 1; k < runners.size(); ++k) {
      const EngineInfo &a = runners[i].world.info(), &b = runners[k].world.info();
      PairDifference pair;
      pair.a = a.name;
      pair.b = b.name;
      pair.same_laws = a.laws == b.laws;
      pair.tolerances = pair.same_laws ? DivergenceTolerances::exact() : tolerances;
      pairs.push_back(std::move(pair));
    }
  }
  return pairs;
}

}  // namespace

Comparison compare_engines(const std::vector<std::unique_ptr<PhysicsBackend>>& worlds, const WalkSetup& setup,
                           const DivergenceTolerances& tolerances, const Progress& progress,
                           const TraceSinks& sinks) {
  std::vector<Runner> runners;
  runners.reserve(worlds.size());
  for (const auto& world : worlds) {
    runners.push_back(
        {*world,
         Walk(*world, setup.make_controller(world->spec()), setup.timing, {}, setup.terminations),
         {}});
  }
  Comparison result;
  result.pairs = pairs_of(runners, tolerances);
  const int steps = setup.timing.control_steps();
  try {
    for (int done = 1; done <= steps; ++done) {
      advance(runners, sinks);
      compare(runners, result.pairs);
      constexpr int kStepsPerReport = 100;
      if (progress && done % kStepsPerReport == 0) progress(static_cast<double>(done) / steps);
    }
  } catch (const Interrupted&) {
    result.interrupted = true;
  }
  for (const Runner& r : runners) {
    result.runs.push_back(
        {r.world.info(), r.world.spec().terrain.name(), setup.gait, r.walk.summary(), result.interrupted});
  }
  return result;
}

WalkRun record_walk(PhysicsBackend& world, const WalkSetup& setup, const Progress& progress, TraceSink* sink,
                    const Start& start) {
  WalkRun run{world.info(), world.spec().terrain.name(), setup.gait, {}, false};
  Walk walk(world, setup.make_controller(world.spec()), setup.timing, start, setup.terminations);
  const int steps = setup.timing.control_steps();
  try {
    for (int done = 1; walk.advance(); ++done) {
      if (sink != nullptr) sink->add(TraceSample(world, walk.sample().targets));
      constexpr int kStepsPerReport = 100;
      if (progress && done % kStepsPerReport == 0) progress(static_cast<double>(done) / steps);
    }
  } catch (const Interrupted&) {
    run.interrupted = true;
  }
  run.summary = walk.summary();
  return run;
}

}  // namespace crossgait
