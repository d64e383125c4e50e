// Actions that command joints: servo target = home + scale x action (EnvConfig::action).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "env/env_model.h"
#include "motion/controller.h"

namespace crossgait {

/// The targets of an episode, and those that are still on their way. A value: a copy goes on from there.
class JointControl final : public Controller {
 public:
  /// @throws ConfigError if the robot's chains do not meet at home
  explicit JointControl(const EnvModel& model);

  /// An episode begins, at home. @param command  that the policy is told to follow
  void restart(const std::optional<VelocityCommand>& command);
  /// @param action  in the order of the table, clipped; its targets hold from the next control step, or that
  ///                many later which the delay takes
  void apply(std::span<const double> action) noexcept;
  void set_command(const VelocityCommand& command) noexcept { command_ = command; }

  RobotState initial_state(const Terrain& terrain, const Placement& placement) const override;
  void hold_pose(double dt, ControlTargets& out) noexcept override;
  void advance(double dt, ControlTargets& out) noexcept override;

 private:
  std::shared_ptr<const RobotDescription> robot_;
  std::vector<double> home_, scale_;  // rad, in the order of the action
  std::vector<Eigen::Index> slots_;   // in JointTargets, in that order
  JointVector standing_;              // all joints at home, rad
  JointTargets wanted_;               // by the last action
  std::vector<JointTargets> line_;    // wanted in the last control steps, as many as the delay has
  std::size_t oldest_ = 0;
  std::optional<VelocityCommand> command_;
};

}  // namespace crossgait
