// An environment's configuration with what the files it names say.
#pragma once

#include <memory>

#include "env/env_config.h"
#include "physics/terrain/terrain_source.h"
#include "policy/actuator_network.h"

namespace crossgait {

/// Holds a configuration whose robot and ground are read once, however many environments are made of it:
/// whoever describes it, runs it and shows it means the same robot on the same ground.
struct LoadedEnv {
  EnvConfig config;
  std::shared_ptr<const RobotDescription> robot;  ///< as its file has it; `config.servos` come on top
  TerrainSource ground;
  std::shared_ptr<const ActuatorNetwork> actuator;  ///< that `config.joints.actuator` names, or null

  /// Reads the robot; the ground follows when it is first made. Not explicit: a configuration may stand
  /// wherever one that is read is asked for. @throws ConfigError for a configuration that is not valid, or a
  /// robot that cannot be read
  LoadedEnv(const EnvConfig& environment);
  /// Takes a robot that has been read from where `environment.robot` says, and a network of its actuators if
  /// that has been. @throws ConfigError for a network that cannot be read
  LoadedEnv(EnvConfig environment, std::shared_ptr<const RobotDescription> read,
            std::shared_ptr<const ActuatorNetwork> network = nullptr);

  /// Returns other settings of the environment: what they name by another text is read, and nothing else.
  /// @throws ConfigError
  LoadedEnv with(EnvConfig changed) const;
};

}  // namespace crossgait
