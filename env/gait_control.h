// Actions that adjust a gait: its parameters and its foot targets (EnvConfig::action).
#pragma once

#include <optional>
#include <span>

#include "env/env_model.h"
#include "motion/leg_controller.h"

namespace crossgait {

/// The gait of an episode, the legs that follow it and the heading that it keeps. A value: a copy goes on
/// from there.
class GaitControl {
 public:
  /// @throws ConfigError as LegController
  explicit GaitControl(const EnvModel& model);

  /// An episode begins, from the stand. @param command  empty: steps of step_length
  void restart(const std::optional<VelocityCommand>& command);
  /// @param action  in [-1, 1], as AdaptiveGaitController takes it
  void apply(std::span<const double> action) noexcept { controller_.apply_action(action); }
  /// From the next step on; finite.
  void set_command(const VelocityCommand& command) noexcept;

  /// The functions of a TargetSource.
  RobotState stand(const Terrain& terrain, const Placement& placement) const {
    return legs_.standing_state(standing_, terrain, placement);
  }
  void hold(double dt, ControlTargets& out) noexcept { solve_legs(legs_, standing_, dt, out); }
  void look(const RobotState& state, double dt) noexcept;
  void advance(double dt, ControlTargets& out) noexcept;

  const AdaptiveGaitController& controller() const noexcept { return controller_; }

 private:
  AdaptiveGaitController controller_;
  LegController legs_;
  HeadingHold hold_heading_;
  HeadingHoldState heading_;
  std::optional<VelocityCommand> command_;
  LegArray<Vector3> standing_{};  // feet before the first step, in the leg frames, m
};

}  // namespace crossgait
