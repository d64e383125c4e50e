// A robot that stands and nothing else: where its joints end up under its weight.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "physics/engine/world_spec.h"

namespace crossgait {

struct StandingJoint {
  std::string name;
  double target = 0, reached = 0;  ///< rad
  double torque = 0;               ///< of the servo, N m
  double share_of_effort = 0;      ///< of the torque limit in that direction, 0 to 1
};

struct Standing {
  std::string engine;
  /// "stood"; "collapsed" where something other than feet bears a tenth of the weight or more at the end, or
  /// the base is lower by half the standing height; "diverged", and then nothing else is told.
  std::string outcome;
  double height = 0;                  ///< of the base's origin, m
  double sag = 0;                     ///< below where it would be at the targets, m
  double roll = 0, pitch = 0;         ///< rad
  std::vector<StandingJoint> joints;  ///< servos; means over the last quarter of a second
};

/// Holds the servos at the home pose for `seconds` of simulated time, from the home pose at rest on the
/// ground, in each engine. @throws ConfigError for an engine that is not there, or fewer seconds than 0.5
std::vector<Standing> stand(const WorldSpec& world, const std::vector<std::string>& engines, double seconds);

/// Writes a table for each engine.
std::string describe(const std::vector<Standing>& standings);
/// Writes by engine: `outcome, height_m, sag_m, roll_rad, pitch_rad`, `joints` of `name, target, reached,
/// torque, share_of_effort`.
nlohmann::ordered_json to_json(const std::vector<Standing>& standings);

}  // namespace crossgait
