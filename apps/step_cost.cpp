#include "apps/step_cost.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "apps/command.h"
#include "backends/registry.h"
#include "backends/served_engine.h"
#include "env/env_model.h"

namespace crossgait::apps {
namespace {

using Clock = std::chrono::steady_clock;

/// Measures a step of standing, s. In the first ones feet reach the ground, and an engine does what it does
/// once.
double seconds_a_step(PhysicsBackend& world) {
  constexpr int kBefore = 8, kSteps = 5;
  const std::vector<int> servos = world.robot().actuated_joints();
  JointTargets targets{JointVector(static_cast<Eigen::Index>(servos.size()))};
  for (std::size_t i = 0; i < servos.size(); ++i) {
    targets.q[static_cast<Eigen::Index>(i)] = world.state().q[servos[i]];
  }
  static_cast<void>(world.step(targets, kBefore));
  const Clock::time_point begin = Clock::now();
  static_cast<void>(world.step(targets, kSteps));
  return std::chrono::duration<double>(Clock::now() - begin).count() / kSteps;
}

bool is_served(const std::string& engine) { return engine.starts_with(kServedPrefix); }

std::string rounded(double seconds) {
  constexpr double kMinute = 60, kHour = 3600, kInMinutes = 120, kInHours = 7200;
  if (seconds >= kInHours) return fmt::format("{:.1f} h", seconds / kHour);
  if (seconds >= kInMinutes) return fmt::format("{:.0f} min", seconds / kMinute);
  return fmt::format("{:.0f} s", seconds);
}

}  // namespace

void note_cost(const std::vector<std::string>& engines, const WorldSpec& world, double seconds,
               std::string_view what) {
  constexpr double kWorthSaying = 10, kMilli = 1e-3;
  const double steps = seconds / world.physics_dt;
  for (const std::string& engine : engines) {
    if (!is_served(engine)) continue;
    const double step = seconds_a_step(*make_world(engine, world));
    if (step * steps < kWorthSaying) continue;
    print_notes({fmt::format("{} takes {:.1f} ms a step: about {} for the {:.0f} steps of {}", engine,
                             step / kMilli, rounded(step * steps), steps, what)});
  }
}

void note_cost(const std::vector<std::string>& engines, const WorldSpec& world, const WalkTiming& timing) {
  note_cost(engines, world, timing.settle_seconds + timing.seconds, "this walk");
}

void note_cost(const std::vector<std::string>& engines, const LoadedEnv& environment, double seconds,
               std::size_t motions, std::string_view what) {
  if (std::ranges::none_of(engines, is_served)) return;
  const double each = environment.config.settle_seconds + seconds;
  note_cost(engines, EnvModel::make(environment)->world, each * static_cast<double>(motions), what);
}

}  // namespace crossgait::apps
