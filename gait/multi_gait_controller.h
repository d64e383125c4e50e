// Chooses the gait by the speed asked for.
#pragma once

#include <vector>

#include "gait/gait_generator.h"

namespace crossgait {

/// Holds a gait and the speeds it is for.
struct SpeedBand {
  Gait gait;
  double below =
      0;  ///< used for speeds below this and not below the previous band's, m/s; the last band has no end
};

/// Returns two bands: walk below 0.08 m/s, trot above, each with its preferred parameters.
std::vector<SpeedBand> default_speed_bands();
/// Returns the guide's bands: walk below 0.1 m/s, trot below 0.3, gallop above.
std::vector<SpeedBand> guide_speed_bands();

struct MultiGaitOptions {
  std::vector<SpeedBand> bands = default_speed_bands();
  /// Replaces the parameters of every gait, but for cycle_time and duty_factor, which are the gait's
  /// preferred ones. Empty: all of its preferred parameters.
  std::optional<GaitParameters> parameters;
  double hysteresis =
      0.02;  ///< a slower gait takes over this far below the speed where the faster one did, m/s
  double longest_step = 0.09;  ///< forward, m; sideways in proportion to `limits`. The cycle shortens first,
  double shortest_cycle = 0.15;  ///< down to this, s; then steps grow up to their limits
  StepLimits limits;
};

/// Returns the guide's bands, and how it shortens its cycles.
MultiGaitOptions guide_multi_gait_options();

/// Walks at a commanded velocity with the gait for its speed (of the fastest foot, for turns), or with a
/// forced one; stands at zero, reverses, and changes from one gait to the next without a jump (see
/// GaitGenerator).
class MultiGaitController {
 public:
  /// Stands until commanded. @param p_BL  origins of the leg frames in the base frame, m
  /// @throws ConfigError naming the option
  MultiGaitController(const MultiGaitOptions& options, const LegArray<Vector3>& p_BL);

  /// Goes back to standing still, with no command and no forced gait.
  void reset() noexcept;

  /// Sets the forward speed, m/s; negative reverses. @returns false, changing nothing, if it is not finite
  [[nodiscard]] bool set_speed(double speed) noexcept { return set_command({speed, 0, 0}); }
  /// @returns false, changing nothing, if it is not finite
  [[nodiscard]] bool set_command(const VelocityCommand& command) noexcept;
  /// Sets MultiGaitOptions::parameters. @returns false, changing nothing, if they are not valid
  [[nodiscard]] bool set_parameters(const GaitParameters& parameters) noexcept;

  /// Does what GaitGenerator's does.
  void set_rolling_correction(const Vector2& sweep) noexcept { generator_.set_rolling_correction(sweep); }
  /// Does what GaitGenerator's does. It has no say in the choice of gait.
  void set_steering(double yaw_rate) noexcept { generator_.set_steering(yaw_rate); }

  /// Uses this gait at every speed. It must be valid.
  void force_gait(const Gait& gait) noexcept;
  /// Undoes `force_gait`.
  void choose_gait_by_speed() noexcept;

  const LegArray<FootTarget>& update(double dt) noexcept { return generator_.update(dt); }

  const VelocityCommand& command() const noexcept { return command_; }
  /// Returns the generator: targets, phase, gait, limit factor and the rest.
  const GaitGenerator& generator() const noexcept { return generator_; }

 private:
  void choose() noexcept;
  std::size_t band_for(double speed) const noexcept;
  LegArray<Vector2> foot_velocities_asked() const noexcept;
  double cycle_time(const Gait& gait, const LegArray<Vector2>& velocity) const noexcept;

  MultiGaitOptions options_;
  LegArray<Vector3> p_BL_;
  VelocityCommand command_;
  std::optional<Gait> forced_;
  std::size_t band_ = 0;
  GaitGenerator generator_;
};

}  // namespace crossgait
