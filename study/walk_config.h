// Everything that makes a walk, before any engine is chosen.
#pragma once

#include <string>

#include "env/env_config.h"
#include "motion/gait_source.h"
#include "parity/comparison.h"

namespace crossgait {

/// Describes a walk; the initialisers are the defaults of `crossgait walk`.
struct WalkConfig {
  std::string robot = "scara_quadruped";  ///< a bundled robot or a file
  std::string terrain = "flat";           ///< as `make_terrain` takes it
  std::uint64_t terrain_seed = 0;
  ContactSettings contact;   ///< over what the robot's file says
  double physics_dt = 1e-3;  ///< s

  GaitChoice gait = choose_gait("trot", {});
  bool compensation = true;  ///< make up for the servos' lag and give
  bool heading_hold = true;  ///< steer to the heading that the command leads to
  WalkTiming timing;
  OutcomeSet terminations = OutcomeSet::of_walks();  ///< outcomes that end it before its time

  /// Returns the controller's side of it.
  WalkSetup setup() const;
  /// Describes an environment in which the zero policy walks like this, one policy step per control step.
  /// @throws ConfigError for what an environment cannot do: `auto`, no compensation
  EnvConfig environment() const;
};

}  // namespace crossgait
