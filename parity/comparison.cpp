#include "crossgait/parity/comparison.h"

namespace crossgait {

WalkRun record_walk(PhysicsBackend& backend, const WalkSetup& setup, const Progress& progress) {
  WalkRun run{backend.info(), backend.spec().terrain.name(), setup.gait, {}, {}};
  setup.timing.validate(backend.spec().physics_dt);
  const auto steps = static_cast<std::size_t>(setup.timing.control_steps());
  run.trace.reserve(steps);
  const TargetSource source = setup.make_source(backend.spec().robot);
  run.summary = run_walk(
      backend, source, setup.timing,
      [&](const WalkSample& sample) {
        run.trace.emplace_back(sample.world, sample.targets);
        constexpr std::size_t kStepsPerReport = 100;
        if (progress && run.trace.size() % kStepsPerReport == 0) {
          progress(static_cast<double>(run.trace.size()) / static_cast<double>(steps));
        }
        return true;
      },
      {}, setup.ends);
  return run;
}

Comparison compare_engines(const std::vector<std::unique_ptr<PhysicsBackend>>& backends,
                           const WalkSetup& setup, const DivergenceTolerances& tolerances,
                           const Progress& progress) {
  Comparison result;
  const double count = static_cast<double>(backends.size());
  for (const auto& backend : backends) {
    const double done = static_cast<double>(result.runs.size());
    const Progress part =
        progress ? Progress([&](double share) { progress((done + share) / count); }) : Progress{};
    result.runs.push_back(record_walk(*backend, setup, part));
  }
  for (std::size_t i = 0; i < result.runs.size(); ++i) {
    for (std::size_t k = i + 1; k < result.runs.size(); ++k) {
      const WalkRun& a = result.runs[i];
      const WalkRun& b = result.runs[k];
      const bool same_laws = a.engine.laws == b.engine.laws;
      PairDifference pair =
          compare_traces(a.trace, b.trace, same_laws ? DivergenceTolerances::exact() : tolerances);
      pair.a = a.engine.name;
      pair.b = b.engine.name;
      result.pairs.push_back(std::move(pair));
    }
  }
  return result;
}

}  // namespace crossgait
