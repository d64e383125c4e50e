#include "crossgait/env/walk.h"

#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "crossgait/env/time_steps.h"
#include "crossgait/physics/error.h"

namespace crossgait {

void WalkTiming::validate(double physics_dt) const {
  const auto require = [](bool ok, const char* element, const char* expected, double found) {
    if (!ok) throw ConfigError("walk", element, expected, fmt::format("{}", found));
  };
  require(std::isfinite(seconds) && seconds > 0 && seconds <= 1e6, "seconds", "a time in (0, 1e6] s",
          seconds);
  require(std::isfinite(control_dt) && control_dt > 0 && control_dt <= 1, "control_dt",
          "a time step in (0, 1] s", control_dt);
  require(std::isfinite(settle_seconds) && settle_seconds >= 0, "settle_seconds", "a time >= 0 s",
          settle_seconds);
  static_cast<void>(whole_steps("control_dt", control_dt, physics_dt));
}

int WalkTiming::control_steps() const { return step_count(seconds, control_dt); }

MotionSummary run_walk(PhysicsBackend& world, const TargetSource& source, const WalkTiming& timing,
                       const WalkObserver& observer, const Start& start, const OutcomeSet& ends) {
  const auto begin = std::chrono::steady_clock::now();
  timing.validate(world.spec().physics_dt);
  ClosedLoop loop(world.robot(), {timing.control_dt, timing.settle_seconds, {}, ends});
  loop.start(world, source, start);
  for (int i = 0; i < timing.control_steps() && !loop.ended(); ++i) {
    loop.advance(world, source, 1);
    // A step that diverged has nothing to show: the world still holds the state before it.
    if (loop.statistics().has(Outcome::kDiverged)) break;
    if (observer && !observer({world, loop.targets()})) break;
  }
  MotionSummary summary = loop.statistics().summary(world);
  summary.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return summary;
}

}  // namespace crossgait
