// What drives a robot through a motion: where its joint targets come from.
#pragma once

#include <functional>
#include <optional>

#include "gait/parameters.h"
#include "gait/velocity_command.h"
#include "physics/robot/leg.h"
#include "physics/robot/state.h"
#include "physics/terrain/terrain.h"

namespace crossgait {

/// Where a robot is put down: over (x, y) in W, m, turned by the angles, rad.
struct Placement {
  double x = 0, y = 0, roll = 0, pitch = 0, yaw = 0;
};

/// What a leg is meant to do in a control step.
struct LegPlan {
  bool swing = false;   ///< to be in the air
  double progress = 0;  ///< of that swing or stance, 0 to 1
};

/// One control step's targets, and what the source means by them as far as it knows.
struct ControlTargets {
  JointTargets joints;
  std::optional<LegArray<LegPlan>> plan;    ///< where there is a gait
  std::optional<VelocityCommand> velocity;  ///< of the body, that the motion is meant to have
  std::optional<GaitParameters> parameters;
  double limit_factor = 1;  ///< share of a velocity command that the steps can follow
  int ik_clamped = 0;       ///< leg solutions of this step that were not exact
};

/// A gait, recorded feet, a policy: any of them is three functions, and a fourth for those that look where
/// the robot is. They are called by one thread, and may throw; a source serves one motion.
struct TargetSource {
  /// The robot at rest as it stands on `terrain` before the motion. Throws ConfigError if it cannot.
  std::function<RobotState(const Terrain& terrain, const Placement& placement)> stand;
  /// Targets that hold that pose for the next dt (s).
  std::function<void(double dt, ControlTargets& targets)> hold;
  /// Targets of the motion for the next dt (s).
  std::function<void(double dt, ControlTargets& targets)> advance;
  /// What feedback there is: told where the robot is before the motion's next dt (s). May be empty.
  std::function<void(const RobotState& state, double dt)> look = nullptr;
};

}  // namespace crossgait
