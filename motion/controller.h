// What drives a robot through a motion: what computes its next joint targets.
#pragma once

#include <memory>
#include <optional>

#include "gait/parameters.h"
#include "gait/velocity_command.h"
#include "physics/robot/leg.h"
#include "physics/robot/state.h"
#include "physics/terrain/terrain.h"

namespace crossgait {

/// Says where a robot is put down: over (x, y) in W, m, turned by the angles, rad.
struct Placement {
  double x = 0, y = 0, roll = 0, pitch = 0, yaw = 0;
};

/// Says what a leg is meant to do in a control step.
struct ScheduledLeg {
  bool swing = false;   ///< to be in the air
  double progress = 0;  ///< of that swing or stance, 0 to 1
};

/// Holds one control step's targets, and what the controller means by them as far as it knows.
struct ControlTargets {
  JointTargets joints;
  std::optional<LegArray<ScheduledLeg>> contact_schedule;  ///< where there is a gait
  std::optional<VelocityCommand> velocity;                 ///< of the body, that the motion is meant to have
  std::optional<GaitParameters> parameters;
  double limit_factor = 1;  ///< share of a velocity command that the steps can follow
  int ik_clamped = 0;       ///< leg solutions of this step that were not exact
};

/// Computes joint targets step by step: a gait, recorded feet, a policy's action. One thread calls it, for
/// one motion at a time; its functions may throw. Controllers that are values are copied to save a motion.
class Controller {
 public:
  virtual ~Controller() = default;

  /// Returns the robot at rest as it stands on `terrain` before the motion. Throws ConfigError if it cannot.
  virtual RobotState initial_state(const Terrain& terrain, const Placement& placement) const = 0;
  /// Sets targets that hold that pose for the next dt (s).
  virtual void hold_pose(double dt, ControlTargets& targets) = 0;
  /// Sets targets of the motion for the next dt (s).
  virtual void advance(double dt, ControlTargets& targets) = 0;
  /// Takes in where the robot is before the motion's next dt (s): what feedback there is. Nothing by default.
  virtual void observe(const RobotState& /*state*/, double /*dt*/) {}

 protected:
  Controller() = default;
  Controller(const Controller&) = default;
  Controller& operator=(const Controller&) = default;
  Controller(Controller&&) = default;
  Controller& operator=(Controller&&) = default;
};

/// A controller that is made for a run: whoever makes the run and whoever made the controller may hold it.
using ControllerPtr = std::shared_ptr<Controller>;

}  // namespace crossgait
