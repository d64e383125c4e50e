// From the velocity asked of the body to a step of each foot.
#pragma once

#include "gait/foot_trajectory.h"

namespace crossgait {

/// Holds a velocity of the body in its own heading frame.
struct VelocityCommand {
  double vx = 0;        ///< forward, m/s
  double vy = 0;        ///< left, m/s
  double yaw_rate = 0;  ///< counter-clockwise seen from above, rad/s

  bool is_finite() const noexcept;
};

/// Holds the longest steps that are taken: a step vector must lie in the ellipse with these axes. The
/// defaults are what the legs of scara_quadruped reach at the default stance with lifts up to 4 cm;
/// `reachable_steps` finds those of any leg and gait.
struct StepLimits {
  double max_x = 0.13;   ///< forward or backward, m
  double max_y = 0.054;  ///< sideways, m
};

/// @throws ConfigError unless both are positive and finite
void validate(const StepLimits& limits, std::string_view source);

/// Returns the velocity over the ground that each foot must have in stance, backwards: v + yaw_rate x p, m/s.
/// @param feet  standing foot positions (x, y) in the base frame, m
LegArray<Vector2> foot_velocities(const VelocityCommand& command, const LegArray<Vector2>& feet) noexcept;

/// Returns four zero vectors (Eigen's own default is no value at all).
inline LegArray<Vector2> no_steps() noexcept {
  LegArray<Vector2> steps;
  steps.fill(Vector2::Zero());
  return steps;
}

struct StepPlan {
  LegArray<Vector2> step = no_steps();  ///< step vectors, m
  /// Fraction of the command that the steps follow, in (0, 1]. All steps shrink alike, so the body goes where
  /// it was told, only slower.
  double limit_factor = 1;
};

/// Plans steps that carry the body at `velocity` (per foot, m/s): velocity times the time the foot stands.
/// @param stance_time  duty factor times cycle time, s
StepPlan plan_steps(const LegArray<Vector2>& velocity, double stance_time, const StepLimits& limits) noexcept;

}  // namespace crossgait
