// The main job: the same walk on several engines, side by side.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "motion/trace.h"
#include "motion/walk.h"
#include "parity/divergence.h"
#include "physics/core/progress.h"

namespace crossgait {

/// One engine's walk.
struct WalkRun {
  EngineInfo engine;
  std::string terrain, gait;
  MotionSummary summary;
  bool interrupted = false;  ///< before its time, by a Progress that threw Interrupted
};

struct Comparison {
  std::vector<WalkRun> runs;
  std::vector<PairDifference> pairs;  ///< every two runs, in order
  bool interrupted = false;           ///< all runs in the same step, as WalkRun
};

/// The controller's side of a walk, the same for every engine.
struct WalkSetup {
  std::string gait;  ///< its name, for reports
  /// Makes a fresh controller for each run in that world: state must not leak from one into the next.
  std::function<ControllerPtr(const WorldSpec& world)> make_controller;
  WalkTiming timing;
  OutcomeSet terminations = OutcomeSet::of_walks();  ///< outcomes that end the walk before its time
};

/// Walks once on `world`. If `progress` throws Interrupted, what was walked until then is returned.
/// @param sink  takes every control step, if there is one
WalkRun record_walk(PhysicsBackend& world, const WalkSetup& setup, const Progress& progress = {},
                    TraceSink* sink = nullptr, const Start& start = {});

/// All walks in step, compared as they go: memory does not grow with their length. Interrupted as
/// `record_walk`.
/// @param tolerances for pairs of which one is an independent opinion; two engines of the same laws
///                   are held to `DivergenceTolerances::exact()`
/// @param sinks  take every control step of each walk
Comparison compare_engines(const std::vector<std::unique_ptr<PhysicsBackend>>& worlds, const WalkSetup& setup,
                           const DivergenceTolerances& tolerances = {}, const Progress& progress = {},
                           const TraceSinks& sinks = {});

}  // namespace crossgait
