// Actions that adjust a gait: its parameters and its foot targets (EnvConfig::action).
#pragma once

#include <optional>
#include <span>

#include "env/env_model.h"
#include "motion/gait_walker.h"

namespace crossgait {

/// Walks the gait of an episode. A value: a copy goes on from there.
class GaitControl final : public GaitWalker<AdaptiveGaitController> {
 public:
  /// @throws ConfigError as FootTargetTracker
  explicit GaitControl(const EnvModel& model);

  /// Begins an episode, from the stand. @param command  empty: steps of step_length
  void restart(const std::optional<VelocityCommand>& command);
  /// @param action  in [-1, 1], as AdaptiveGaitController takes it
  void apply(std::span<const double> action) noexcept { mutable_generator().apply_action(action); }
  /// Sets a finite command, from the next step on.
  void set_command(const VelocityCommand& command) noexcept;

  const AdaptiveGaitController& controller() const noexcept { return generator(); }
};

}  // namespace crossgait
