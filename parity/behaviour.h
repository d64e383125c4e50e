// What a verdict is about: something that a robot does in an engine, and the numbers that sum it up.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "env/evaluation.h"
#include "parity/comparison.h"

namespace crossgait {

/// One number of a run.
struct Statistic {
  std::string name, unit;
  /// A difference that nobody would act on, whichever is larger: a share of the statistic's size, or a fixed
  /// amount in its unit.
  double relative_floor = 0, absolute_floor = 0;
  bool counts_failures = false;  ///< 1 for a run that failed (MotionSummary::failed), else 0
};

/// One way of setting up the same world that a user chooses without meaning anything by it.
struct Variation {
  enum class Kind { kNominal, kTimeStep, kSolver };
  std::string name = "as asked";
  Kind kind = Kind::kNominal;
  double step = 1, tolerance = 1, iterations = 1;  ///< factors on the world's

  void apply(WorldSpec& world) const;
};

/// Nominal; time step halved, doubled; solver tolerance a hundred times looser with half the iterations, and
/// a hundred times tighter with twice as many.
const std::vector<Variation>& variations();

/// How far apart the starts of a verdict lie. Each start draws uniformly, the same in every engine.
struct StartRanges {
  /// Each way along x and y; empty: .1 m of the reference robot, by size (gait/scale.h).
  std::optional<double> position_m = {};
  double heading_rad = 0.2;  ///< each way
  double tilt_rad = 0.02;    ///< roll and pitch, each way
  /// One sideways push of the trunk in the first second, from any direction: the speed it would give to the
  /// whole robot. Empty: .02 m/s of the reference robot, by size.
  std::optional<double> push_mps = {};

  /// With everything that goes by the robot's size.
  StartRanges with_defaults(const RobotDescription& robot) const;

  /// The same as ranges of an environment. Rows of `base` that are on stay as they are.
  Randomisation over(Randomisation base, const RobotDescription& robot) const;
};

/// A behaviour can be run in any engine, from any of infinitely many starts, under any variation. `run` may
/// be called from several threads at once and depends on nothing but its arguments.
struct Behaviour {
  std::string name;
  std::vector<Statistic> statistics;
  /// @returns one value per statistic. @throws ConfigError
  std::function<std::vector<double>(const Engine& engine, const Variation& variation, std::size_t start)> run;
  /// The same as a trace, as asked, without the time to settle, so that the first touch is on
  /// it. Empty for behaviours that record none.
  std::function<Trace(const Engine& engine, std::size_t start)> trace;
  double physics_dt = 0, control_dt = 0;  ///< s, as asked
  std::vector<double> delays;             ///< of the robot's drives, s; none of them 0

  /// False where control step or delays would no longer be whole numbers of physics steps.
  bool allows(const Variation& variation) const;
};

/// Seed of the ground of start `k` where random terrains have this seed: derived as those of starts are, so
/// that no two seeds share a ground, and by another stream of numbers than the start's.
std::uint64_t terrain_seed_of_start(std::uint64_t terrain_seed, std::size_t k) noexcept;

/// The ground of start `k`; random terrains differ from start to start.
using TerrainOfStart = std::function<Terrain(std::size_t start)>;

/// A gait, walked by `run_walk`. @param world whose terrain is replaced by `terrain`'s
Behaviour walk_behaviour(const WorldSpec& world, const WalkSetup& setup, const TerrainOfStart& terrain,
                         const StartRanges& ranges = {}, std::uint64_t seed = 0);

/// A policy in its environment, from starts of the same ranges; those that its randomisation has on stay as
/// they are. Runs read no file of the environment's.
Behaviour policy_behaviour(LoadedEnv environment, PolicyFactory policy, const std::string& name,
                           const StartRanges& ranges = {}, std::uint64_t seed = 0);

}  // namespace crossgait
