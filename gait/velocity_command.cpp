#include "gait/velocity_command.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {

bool VelocityCommand::is_finite() const noexcept {
  return std::isfinite(vx) && std::isfinite(vy) && std::isfinite(yaw_rate);
}

void validate(const StepLimits& limits, std::string_view source) {
  for (const auto& [name, value] : {std::pair("max_x", limits.max_x), std::pair("max_y", limits.max_y)}) {
    if (!(value > 0 && std::isfinite(value))) {
      throw ConfigError(source, name, "a positive length in m", fmt::format("{:g}", value));
    }
  }
}

LegArray<Vector2> foot_velocities(const VelocityCommand& command, const LegArray<Vector2>& feet) noexcept {
  LegArray<Vector2> velocity;
  for (const Leg leg : kLegs) {
    velocity[leg] = {command.vx - command.yaw_rate * feet[leg].y(),
                     command.vy + command.yaw_rate * feet[leg].x()};
  }
  return velocity;
}

StepPlan plan_steps(const LegArray<Vector2>& velocity, double stance_time,
                    const StepLimits& limits) noexcept {
  StepPlan plan;
  double longest = 1;  // squared, in units of the limit
  for (const Leg leg : kLegs) {
    plan.step[leg] = velocity[leg] * stance_time;
    const double x = plan.step[leg].x() / limits.max_x, y = plan.step[leg].y() / limits.max_y;
    longest = std::max(longest, x * x + y * y);
  }
  if (longest > 1) {
    plan.limit_factor = 1 / std::sqrt(longest);
    for (Vector2& step : plan.step) step *= plan.limit_factor;
  }
  return plan;
}

}  // namespace crossgait
