// What a verdict is about: something that a robot does in an engine, and the numbers that sum it up.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "env/evaluation.h"
#include "parity/comparison.h"
#include "parity/margin.h"
#include "parity/variation.h"

namespace crossgait {

/// Describes one number of a run.
struct Statistic {
  std::string key, name, unit;
  Margin margin;
};

/// Says how far apart the starts of a verdict lie. Each start draws uniformly, the same in every engine.
struct StartRanges {
  /// What may be asked for: m, rad and m/s.
  static constexpr double kMostPosition = 100, kMostHeading = 3.14159, kMostPush = 10;

  /// Each way along x and y; empty: 0.1 m of the reference robot, by size (gait/scale.h).
  std::optional<double> position_m = {};
  double heading_rad = 0.2;  ///< each way
  double tilt_rad = 0.02;    ///< roll and pitch, each way
  /// One sideways push of the trunk in the first second, from any direction: the speed it would give to the
  /// whole robot. Empty: 0.02 m/s of the reference robot, by size.
  std::optional<double> push_mps = {};

  /// Returns the ranges with everything that goes by the robot's size.
  StartRanges with_defaults(const RobotDescription& robot) const;

  /// Returns these ranges as those of an environment. Rows of `base` that are on stay as they are.
  Randomisation over(Randomisation base, const RobotDescription& robot) const;
};

/// What sums of steps may be off by, of a step.
inline constexpr double kStepRounding = 1e-6;

/// Holds what came of a run.
struct BehaviourRun {
  std::vector<std::optional<double>> values;  ///< one per statistic; empty where the motion has none
  Outcome outcome = Outcome::kWalked;
  double seconds = 0;  ///< of motion: less than asked if the outcome ended it
};

/// Says that nothing but an outcome ends a run.
inline constexpr double kToTheEnd = std::numeric_limits<double>::infinity();

/// A behaviour can be run in any engine, from any of infinitely many starts, under any variation. `run` may
/// be called from several threads at once and depends on nothing but its arguments.
struct Behaviour {
  std::string name;
  std::vector<Statistic> statistics;
  double seconds = 0;  ///< of a run that nothing ends
  double cut_dt = 0;   ///< runs can be cut to whole multiples of this, s
  /// Runs it once, and no longer than `horizon` s of motion. @throws ConfigError
  std::function<BehaviourRun(const Engine& engine, const Variation& variation, std::size_t start,
                             double horizon)>
      run;
  /// The same as a trace, as asked, every control step of a walk, every step of a policy; of a walk without
  /// the time to settle, so that the first touch is on it. Empty for behaviours that record none.
  std::function<Trace(const Engine& engine, std::size_t start)> trace;
  /// Says what is doubtful of the behaviour itself, by a run of it: actions of a policy that are clipped. May
  /// be empty.
  std::function<std::vector<std::string>(const Engine& engine)> notes;
  double physics_dt = 0, control_dt = 0;  ///< s, as asked
  ContactSpec contact;                    ///< as asked, in steps of that length
  std::vector<double> delays;             ///< of the robot's drives, s; none of them 0

  /// Says why it cannot be run so: control step or delays would no longer be whole numbers of physics steps,
  /// or contacts are as stiff as MuJoCo's law lets them be, or a step undoes more than half of a penetration,
  /// or none of it. Empty where it can.
  std::string why_not(const Variation& variation) const;
  bool allows(const Variation& variation) const { return why_not(variation).empty(); }
};

/// Lists the keys of its statistics.
std::vector<std::string> keys_of(const Behaviour& behaviour);
/// Returns `behaviour` with other margins. @throws ConfigError for a key that is none of its statistics'
Behaviour with_margins(Behaviour behaviour, const Margins& margins);

/// Derives the seed of the ground of start `k` where random terrains have this seed: as those of starts are,
/// so that no two seeds share a ground, and by another stream of numbers than the start's.
std::uint64_t terrain_seed_of_start(std::uint64_t terrain_seed, std::size_t k) noexcept;

/// The ground of start `k`; random terrains differ from start to start.
using TerrainOfStart = std::function<Terrain(std::size_t start)>;

/// Walks a gait by `run_walk` until it fails. @param world whose terrain is replaced by `terrain`'s
Behaviour walk_behaviour(const WorldSpec& world, const WalkSetup& setup, const TerrainOfStart& terrain,
                         const StartRanges& ranges = {}, std::uint64_t seed = 0);

/// Makes a behaviour of a policy in its environment, from starts of the same ranges; those that its
/// randomisation has on stay as they are. Runs read no file of the environment's.
Behaviour policy_behaviour(LoadedEnv environment, PolicyFactory policy, const std::string& name,
                           const StartRanges& ranges = {}, std::uint64_t seed = 0);

}  // namespace crossgait
