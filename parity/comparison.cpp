#include "parity/comparison.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "parity/one_step.h"
#include "physics/robot/hips.h"

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

// What goes with a pair while it is compared.
struct PairWork {
  std::size_t a = 0, b = 0;  ///< runners
  GrowthFit growth;
  std::optional<OneStepCheck> one_step;  ///< of b, from a's states
  bool began_alike = false;              ///< within what a step may differ by
};

void compare(const std::vector<Runner>& runners, std::vector<PairWork>& work,
             std::vector<PairDifference>& pairs) {
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const Runner &a = runners[work[p].a], &b = runners[work[p].b];
    if (work[p].one_step && a.sample) work[p].one_step->add(a.world, *a.sample);
    if (!a.sample || !b.sample) continue;
    const bool had_diverged = pairs[p].first_divergence.has_value();
    const double apart = compare_samples(*a.sample, *b.sample, pairs[p]);
    work[p].growth.add(a.sample->state.time, apart);
    if (!work[p].one_step) continue;
    if (work[p].one_step->difference().steps == 0)
      work[p].began_alike = apart <= one_step_tolerance(pairs[p].precision);
    if (!had_diverged && pairs[p].first_divergence && work[p].began_alike)
      pairs[p].first_divergence->carried = work[p].one_step->carried();
  }
}

std::vector<PairWork> work_of(const std::vector<Runner>& runners, const std::vector<PairDifference>& pairs,
                              int substeps, const AnotherWorld& another) {
  std::vector<PairWork> work;
  for (std::size_t a = 0; a < runners.size(); ++a) {
    for (std::size_t b = a + 1; b < runners.size(); ++b) {
      PairWork pair{a, b, {}, {}, false};
      if (another && pairs[work.size()].same_laws) pair.one_step.emplace(another(b), substeps);
      work.push_back(std::move(pair));
    }
  }
  return work;
}

std::vector<PairDifference> pairs_of(const std::vector<Runner>& runners,
                                     const DivergenceTolerances& tolerances, double leg_length) {
  std::vector<PairDifference> pairs;
  for (std::size_t i = 0; i < runners.size(); ++i) {
    for (std::size_t k = i + 1; k < runners.size(); ++k) {
      pairs.push_back(pair_of(runners[i].world.info(), runners[k].world.info(), tolerances, leg_length));
    }
  }
  return pairs;
}

const WalkRun& run_of(const Comparison& comparison, const std::string& engine) {
  return *std::find_if(comparison.runs.begin(), comparison.runs.end(),
                       [&engine](const WalkRun& r) { return r.engine.name == engine; });
}

// Why a pair of the same laws is not the same; empty if it is.
std::string missed(const Comparison& comparison, const PairDifference& pair) {
  if (pair.one_step && pair.one_step->largest() > one_step_tolerance(pair.precision))
    return fmt::format("{:.1g} apart after one control step from the same state, at {:.3f} s",
                       pair.one_step->largest(), pair.one_step->at_s);
  if (pair.first_divergence) {
    const FirstDivergence& first = *pair.first_divergence;
    const bool grew = first.carried && *first.carried < first.tolerance / 2;
    const bool by_chaos = pair.one_step && (grew || first.time_s > kParityHorizon);
    return by_chaos ? "" : fmt::format("beyond {:.0e} at {:.3f} s", first.tolerance, first.time_s);
  }
  const bool same_time =
      run_of(comparison, pair.a).summary.physics_steps == run_of(comparison, pair.b).summary.physics_steps;
  return same_time ? "" : "walks of different lengths";
}

}  // namespace

std::vector<std::string> missed_parity(const Comparison& comparison) {
  std::vector<std::string> found;
  for (const PairDifference& pair : comparison.pairs) {
    if (!pair.same_laws) continue;
    const std::string why = missed(comparison, pair);
    if (!why.empty()) found.push_back(fmt::format("{} and {} ({})", pair.a, pair.b, why));
  }
  return found;
}

PairDifference pair_of(const EngineInfo& a, const EngineInfo& b, const DivergenceTolerances& tolerances,
                       double leg_length) {
  PairDifference pair;
  pair.a = a.name;
  pair.b = b.name;
  pair.same_laws = a.laws == b.laws;
  const bool coarse =
      Precision::kFloat32 == a.capabilities.precision || Precision::kFloat32 == b.capabilities.precision;
  pair.precision = coarse ? Precision::kFloat32 : Precision::kFloat64;
  pair.tolerances = pair.same_laws ? DivergenceTolerances::exact(pair.precision) : tolerances;
  pair.parting = PartingWatch(leg_length);
  return pair;
}

Comparison compare_engines(const std::vector<std::unique_ptr<PhysicsBackend>>& worlds, const WalkSetup& setup,
                           const DivergenceTolerances& tolerances, const Progress& progress,
                           const TraceSinks& sinks, const AnotherWorld& another) {
  std::vector<Runner> runners;
  runners.reserve(worlds.size());
  for (const auto& world : worlds) {
    runners.push_back(
        {*world,
         Walk(*world, setup.make_controller(world->spec()), setup.timing, {}, setup.terminations),
         {}});
  }
  Comparison result;
  if (!worlds.empty()) result.leg_length_m = leg_length(*worlds.front()->spec().robot);
  result.pairs = pairs_of(runners, tolerances, result.leg_length_m);
  const double physics_dt = worlds.empty() ? 1 : worlds.front()->spec().physics_dt;
  const int substeps = static_cast<int>(std::lround(setup.timing.control_dt / physics_dt));
  std::vector<PairWork> work = work_of(runners, result.pairs, substeps, another);
  const int steps = setup.timing.control_steps();
  try {
    for (int done = 1; done <= steps; ++done) {
      advance(runners, sinks);
      compare(runners, work, result.pairs);
      constexpr int kStepsPerReport = 100;
      if (progress && done % kStepsPerReport == 0) progress(static_cast<double>(done) / steps);
    }
  } catch (const Interrupted&) {
    result.interrupted = true;
  }
  for (std::size_t p = 0; p < work.size(); ++p) {
    result.pairs[p].growth = work[p].growth.fit();
    if (work[p].one_step) result.pairs[p].one_step = work[p].one_step->difference();
  }
  for (const Runner& r : runners) {
    result.runs.push_back({r.world.info(), r.world.spec().terrain.name(), setup.gait, r.world.spec().contact,
                           r.walk.summary(), result.interrupted});
  }
  return result;
}

WalkRun record_walk(PhysicsBackend& world, const WalkSetup& setup, const Progress& progress, TraceSink* sink,
                    const Start& start) {
  WalkRun run{world.info(), world.spec().terrain.name(), setup.gait, world.spec().contact, {}, false};
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
