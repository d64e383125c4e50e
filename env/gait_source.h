// Gaits as sources of foot targets for a walk.
#pragma once

#include <string>
#include <vector>

#include "crossgait/env/walk.h"
#include "crossgait/gait/gait_generator.h"

namespace crossgait {

/// One gait with one set of parameters.
struct GaitChoice {
  Gait gait;
  GaitParameters parameters;
};

/// A gait by name with its preferred parameters, changed by assignments "name=value" (see gait/parameters.h).
/// @throws ConfigError for an unknown gait, parameter or value
GaitChoice choose_gait(const std::string& gait, const std::vector<std::string>& settings);

/// Origins of the leg frames in the base frame, m. @throws ConfigError if the robot has no five-bar legs
LegArray<Vector3> leg_origins(const RobotDescription& robot);

/// Walks `choice` with the legs of `robot`, from standing. Every call makes an independent source.
/// @throws ConfigError if the robot has no five-bar legs
FootTargetSource make_gait_source(const GaitChoice& choice, const RobotDescription& robot);

}  // namespace crossgait
