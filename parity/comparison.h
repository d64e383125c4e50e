// The main job: the same walk on several engines, side by side.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "crossgait/env/progress.h"
#include "crossgait/env/walk.h"
#include "crossgait/parity/divergence.h"

namespace crossgait {

/// One engine's walk.
struct WalkRun {
  EngineInfo engine;
  std::string terrain, gait;
  MotionSummary summary;
  Trace trace;
};

struct Comparison {
  std::vector<WalkRun> runs;
  std::vector<PairDifference> pairs;  ///< every two runs, in order
};

/// The controller's side of a walk, the same for every engine.
struct WalkSetup {
  std::string gait;  ///< its name, for reports
  /// Makes a fresh source for each run: state must not leak from one into the next.
  std::function<TargetSource(std::shared_ptr<const RobotDescription> robot)> make_source;
  WalkTiming timing;
  OutcomeSet ends = OutcomeSet::of_walks();  ///< outcomes that end the walk before its time
};

/// Walks once on `backend`, keeping the whole trace.
WalkRun record_walk(PhysicsBackend& backend, const WalkSetup& setup, const Progress& progress = {});

/// @param tolerances for pairs of which one is an independent opinion; two engines of the same laws
///                   are held to `DivergenceTolerances::exact()`
Comparison compare_engines(const std::vector<std::unique_ptr<PhysicsBackend>>& backends,
                           const WalkSetup& setup, const DivergenceTolerances& tolerances = {},
                           const Progress& progress = {});

}  // namespace crossgait
