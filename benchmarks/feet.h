// The foot-contact card: how well feet stand, land and walk in an engine.
#pragma once

#include <string>
#include <vector>

#include "parity/comparison.h"
#include "scenes/scenes.h"

namespace crossgait::benchmarks {

struct FeetSettings {
  std::vector<std::string> engines;
  std::vector<std::string> terrains{"flat", "rough:seed=1"};
  double stand_seconds = 60;
  int strides = 6;  ///< of each leg, at full step length
  scenes::RobotPtr robot = scenes::quadruped();
};

/// Holds what the feet do in one engine on one terrain, physics step 1 ms.
struct FootCard {
  std::string engine, terrain;
  // Standing in the home pose.
  double stand_seconds = 0;
  double creep_mps = 0;  ///< of the foot that crept farthest, mean speed along the ground in the second half
  double penetration_m = 0;  ///< mean of the feet that touch
  double force_error = 0;    ///< mean vertical force over the weight, - 1
  // Trotting.
  int strides = 0;                   ///< of each leg
  int touchdowns = 0;                ///< a foot that touches again after 20 ms without contact
  double touchdown_impulse = 0;      ///< of the ground on the foot in the first 10 ms, median, N s
  double touchdown_peak = 0;         ///< largest force in these 10 ms over the robot's weight, median
  double toe_drag_per_stride_m = 0;  ///< path of one foot on the ground while it should be in the air, mean
  double slip_per_stride_m = 0;      ///< path that one foot slides while it should stand, mean
  double deepest_m = 0;              ///< largest penetration of a foot
};

/// @throws std::runtime_error if an engine diverges
std::vector<FootCard> measure_feet(const FeetSettings& settings, const Progress& progress);

}  // namespace crossgait::benchmarks
