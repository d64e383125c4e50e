#include "motion/walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "motion/time_steps.h"
#include "physics/core/error.h"

namespace crossgait {

void WalkTiming::validate(double physics_dt) const {
  const auto require = [](bool ok, const char* element, const char* expected, double found) {
    if (!ok) throw ConfigError("walk", element, expected, fmt::format("{}", found));
  };
  require(std::isfinite(seconds) && seconds > 0 && seconds <= kMaxSeconds, "seconds", "a time in (0, 1e6] s",
          seconds);
  require(std::isfinite(control_dt) && control_dt > 0 && control_dt <= 1, "control_dt",
          "a time step in (0, 1] s", control_dt);
  require(std::isfinite(settle_seconds) && settle_seconds >= 0 && settle_seconds <= kMaxSettleSeconds,
          "settle_seconds", "a time in [0, 1e3] s", settle_seconds);
  // Steps are counted in an int.
  const double longest = control_dt * std::numeric_limits<int>::max();
  if (std::max(seconds, settle_seconds) > longest) {
    throw ConfigError(
        "walk", "control_dt",
        fmt::format("a time step of which no more than {} make the walk", std::numeric_limits<int>::max()),
        fmt::format("{} s", control_dt));
  }
  require(control_steps() > 0, "seconds", "at least one control step", seconds);
  static_cast<void>(whole_steps("control_dt", control_dt, physics_dt));
}

int WalkTiming::control_steps() const { return step_count(seconds, control_dt); }

Walk::Walk(PhysicsBackend& world, ControllerPtr controller, const WalkTiming& timing, const Start& start,
           const OutcomeSet& terminations)
    : world_(world),
      controller_(std::move(controller)),
      loop_((timing.validate(world.spec().physics_dt), world.robot()),
            {timing.control_dt, timing.settle_seconds, {}, terminations}),
      steps_left_(timing.control_steps()) {
  const auto begin = Clock::now();
  loop_.start(world_, *controller_, start);
  spent_ = Clock::now() - begin;
}

bool Walk::advance() {
  if (steps_left_ == 0 || loop_.ended()) return false;
  const auto begin = Clock::now();
  --steps_left_;
  loop_.advance(world_, *controller_, 1);
  spent_ += Clock::now() - begin;
  // A step that diverged has nothing to show: the world still holds the state before it.
  return !loop_.statistics().has(Outcome::kDiverged);
}

MotionSummary Walk::summary() const {
  MotionSummary summary = loop_.statistics().summary(world_);
  summary.wall_seconds = std::chrono::duration<double>(spent_).count();
  return summary;
}

MotionSummary run_walk(PhysicsBackend& world, const ControllerPtr& controller, const WalkTiming& timing,
                       const WalkObserver& observer, const Start& start, const OutcomeSet& terminations) {
  Walk walk(world, controller, timing, start, terminations);
  while (walk.advance()) {
    if (observer && !observer(walk.sample())) break;
  }
  return walk.summary();
}

}  // namespace crossgait
