// What one core does not show: worlds on several threads at once, and what the walk around the engine costs.
#pragma once

#include <string>
#include <vector>

#include "benchmarks/speed.h"

namespace crossgait::benchmarks {

struct ScalingSettings {
  std::vector<std::string> engines;
  int max_threads = 1;
  int rounds = 9;   ///< every engine and number of threads has its turn in each
  int repeats = 6;  ///< of the scene by each thread in a turn
  scenes::RobotPtr robot = scenes::quadruped();
};

/// Holds the speed of one engine on so many threads, a world of its own on each.
struct ThreadSpeed {
  std::string engine;
  int threads = 1;
  double steps_per_second = 0;  ///< of all threads together, by the clock on the wall; median
  Quartiles efficiency;         ///< per thread, over that of one thread in the same round
};

/// Measures a trot on the plane. @throws std::runtime_error if an engine diverges
std::vector<ThreadSpeed> measure_scaling(const ScalingSettings& settings, const Progress& progress);

struct OverheadSettings {
  std::vector<std::string> engines;
  int rounds = 15;
  double seconds = 2;  ///< of trot
  scenes::RobotPtr robot = scenes::quadruped();
};

/// Compares a walk (gait, kinematics, engine, statistics) with the engine alone on the servo targets recorded
/// from it.
struct Overhead {
  std::string engine, terrain;
  Quartiles eta;        ///< physics steps per second of the walk over those of the engine alone
  double walk_us = 0;   ///< per physics step, median
  double alone_us = 0;  ///< per physics step, median
};

/// @throws std::runtime_error if the engine alone does not end where the walk did, to the bit
std::vector<Overhead> measure_overhead(const OverheadSettings& settings, const Progress& progress);

}  // namespace crossgait::benchmarks
