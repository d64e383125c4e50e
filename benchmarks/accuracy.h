// Speed against accuracy: each engine against itself at a much smaller step, on the same commands.
//
// One trot, servo targets changed every 8 ms whatever the physics step, so that the step is all that differs.
// The robot settles at the reference step; every run starts from that state. The time looked at is one gait
// cycle (0.8 s): every foot lifts off and lands once. Longer, and a foot that lands a little earlier on one
// side has turned the robot's path, and what is measured is the walk's sensitivity more than the step's
// error.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "parity/comparison.h"
#include "scenes/scenes.h"

namespace crossgait::benchmarks {

inline constexpr double kCommandStep = 8e-3;         ///< s, of the servo targets
inline constexpr double kReferenceStep = 1e-3 / 16;  ///< s
inline constexpr double kAccuracyHorizon = 0.8;      ///< s, one gait cycle
inline constexpr double kStabilityHorizon = 4;       ///< s, five gait cycles

/// Holds the errors of one engine with one step on one terrain.
struct AccuracyPoint {
  std::string terrain, engine;
  double step_s = 0;
  std::optional<double> position_error_m;  ///< root mean square over the cycle; empty: it did not get through
  std::optional<double> joint_error_rad;   ///< the same, over all joints
  double cost = 0;                         ///< CPU seconds per simulated second, median
  double cost_ratio = 1;                   ///< to the first engine at the same step in the same round, median
};

/// Holds the largest step with which the trot neither falls nor diverges.
struct StableStep {
  std::string terrain, engine;
  std::vector<double> tried_s;      ///< ascending, up to the first that fails or 32 ms
  std::optional<double> largest_s;  ///< empty: not even the smallest tried
};

struct Accuracy {
  std::vector<AccuracyPoint> points;
  std::vector<StableStep> stable;
};

struct AccuracySettings {
  std::vector<std::string> engines;
  std::vector<std::string> terrains{"flat", "rough:seed=1"};
  std::vector<double> steps_s{8e-3, 4e-3, 2e-3, 1e-3, 1e-3 / 2, 1e-3 / 4, 1e-3 / 8};
  int rounds = 7;  ///< of timing; every engine and step has its turn in each
  scenes::RobotPtr robot = scenes::quadruped();
};

/// Tells whether five cycles of the trot at this step (commands with every step if it is longer than theirs)
/// stay upright (within 60 degrees), off the belly (base above half its height at home, over the ground) and
/// finite.
bool trot_survives(const std::string& engine, const std::string& terrain, double step,
                   const scenes::RobotPtr& robot = scenes::quadruped());

/// @throws std::runtime_error if an engine does not get through the cycle at the reference step
Accuracy measure_accuracy(const AccuracySettings& settings, const Progress& progress);

}  // namespace crossgait::benchmarks
