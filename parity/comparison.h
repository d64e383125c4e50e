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

/// Holds one engine's walk.
struct WalkRun {
  EngineInfo engine;
  std::string terrain, gait;
  ContactSpec contact;
  MotionSummary summary;
  bool interrupted = false;  ///< before its time, by a Progress that threw Interrupted
};

struct Comparison {
  std::vector<WalkRun> runs;
  std::vector<PairDifference> pairs;  ///< every two runs, in order
  double leg_length_m = 0;            ///< of the robot (Parting)
  bool interrupted = false;           ///< all runs in the same step, as WalkRun
};

/// Holds the controller's side of a walk, the same for every engine.
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

/// Engines of the same laws are held to `exact()` for so long, in simulated time, s, standing included: what
/// rounding begins chaos carries on, by a factor in every half second, and beyond some time it decides.
inline constexpr double kParityHorizon = 1;

/// Names pairs of the same laws that are not the same, with the reason: "mujoco and bullet:matched (4e-08
/// apart after one control step from the same state)". Missed is parity of a control step
/// (one_step_tolerance); over the horizon, unless what single steps differ by does not come to half of
/// it (FirstDivergence::carried), so that chaos alone can have made it; or at any time where steps were not
/// compared one by one.
std::vector<std::string> missed_parity(const Comparison& comparison);

/// Returns a pair of which nothing has been compared yet.
/// @param tolerances  of engines of unlike laws; those of the same are held to `exact()`
/// @param leg_length  of the robot (Parting), m
PairDifference pair_of(const EngineInfo& a, const EngineInfo& b, const DivergenceTolerances& tolerances,
                       double leg_length);

/// Makes another world like one of those that are compared, by its place.
using AnotherWorld = std::function<std::unique_ptr<PhysicsBackend>(std::size_t place)>;

/// Runs all walks in step, compared as they go: memory does not grow with their length. Interrupted as
/// `record_walk`.
/// @param tolerances for pairs of which one is an independent opinion; two engines of the same laws
///                   are held to `DivergenceTolerances::exact()`
/// @param sinks  take every control step of each walk
/// @param another  engines of the same laws are also compared step by step from the same state, in worlds
///                 that it makes; without it they are not
Comparison compare_engines(const std::vector<std::unique_ptr<PhysicsBackend>>& worlds, const WalkSetup& setup,
                           const DivergenceTolerances& tolerances = {}, const Progress& progress = {},
                           const TraceSinks& sinks = {}, const AnotherWorld& another = {});

}  // namespace crossgait
