// Actions that command joints (EnvConfig::action, JointCommand).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "env/env_model.h"
#include "motion/controller.h"

namespace crossgait {

/// Holds the targets of an episode, and those still on their way. A value: a copy goes on from there.
class JointControl final : public Controller {
 public:
  /// @throws ConfigError if the robot's chains do not meet at home
  explicit JointControl(const EnvModel& model);

  /// Begins an episode, at home. @param command  that the policy is told to follow
  void restart(const std::optional<VelocityCommand>& command);
  /// @param action  in the order of the table, clipped; its targets hold from the next control step, or that
  ///                many later which the delay takes
  /// @param state   of that instant, from which relative targets are measured
  void apply(std::span<const double> action, const RobotState& state) noexcept;
  void set_command(const VelocityCommand& command) noexcept { command_ = command; }

  RobotState initial_state(const Terrain& terrain, const Placement& placement) const override;
  void hold_pose(double dt, ControlTargets& out) noexcept override;
  void advance(double dt, ControlTargets& out) noexcept override;
  void observe(const RobotState& state, double dt) noexcept override;

 private:
  double target(std::size_t i, double action, const RobotState& state) const noexcept;

  std::shared_ptr<const RobotDescription> robot_;
  JointActionTable table_;
  double filter_ = 1;
  bool computed_ = false;           // targets are made in every control step, of torques
  JointVector standing_;            // all joints at home, rad
  JointTargets wanted_;             // by the last action; those torques, N m, or velocities, rad/s
  JointTargets by_torque_;          // targets at which servos give the torques of this control step
  std::vector<JointTargets> line_;  // wanted in the last control steps, as many as the delay has
  std::size_t oldest_ = 0;
  std::optional<VelocityCommand> command_;
  std::shared_ptr<const ActuatorNetwork> network_;  // or null
  std::vector<ActuatorNetwork::Memory> memories_;   // of each servo
};

}  // namespace crossgait
