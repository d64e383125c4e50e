#include "motion/closed_loop.h"

#include <fmt/format.h>

#include "motion/time_steps.h"
#include "physics/core/error.h"
#include "physics/engine/lost_engine.h"

namespace crossgait {
namespace {

void check_place(const Terrain& terrain, const Placement& placement) {
  if (terrain.contains(placement.x, placement.y)) return;
  throw ConfigError("start", "start_x, start_y", fmt::format("a place on {}", terrain.name()),
                    fmt::format("({:g}, {:g}) m", placement.x, placement.y));
}

}  // namespace

ClosedLoop::ClosedLoop(const RobotDescription& robot, const Options& options)
    : options_(options), statistics_(robot, options.limits) {}

void ClosedLoop::start(PhysicsBackend& world, Controller& controller, const Start& start) {
  const double dt = options_.control_dt;
  const WorldSpec& spec = world.spec();
  substeps_ = whole_steps("control_dt", dt, spec.physics_dt);
  check_place(spec.terrain, start.placement);
  pushes_ = start.pushes;
  steps_ = 0;
  ended_ = false;
  const RobotState standing = controller.initial_state(spec.terrain, start.placement);
  world.reset(start.state.value_or(standing));

  StepStatus status = StepStatus::kOk;
  const int settling = step_count(options_.settle_seconds, dt), leading = step_count(start.warm_up, dt);
  for (int i = 0; i < settling && status == StepStatus::kOk; ++i) {
    controller.hold_pose(dt, targets_);
    status = control_step(world, false);
  }
  for (int i = 0; i < leading && status == StepStatus::kOk; ++i) {
    next_targets(world, controller);
    status = control_step(world, false);
  }
  const Vector3& p = standing.p_WB;
  statistics_.begin(world, p.z() - spec.terrain.height(p.x(), p.y()));
  if (status != StepStatus::kOk) {
    statistics_.note(Outcome::kDiverged);
    ended_ = true;
  }
}

StepStatus ClosedLoop::control_step(PhysicsBackend& world, bool watched) {
  for (int i = 0; i < substeps_; ++i) {
    if (const StepStatus status = world.step(targets_.joints); status != StepStatus::kOk) {
      throw_if_lost(world);
      return status;
    }
    if (watched) statistics_.add_physics_step(world, targets_);
  }
  return StepStatus::kOk;
}

void ClosedLoop::next_targets(const PhysicsBackend& world, Controller& controller) {
  controller.observe(world.state(), options_.control_dt);
  controller.advance(options_.control_dt, targets_);
}

bool ClosedLoop::advance(PhysicsBackend& world, Controller& controller, int steps) {
  for (int i = 0; i < steps && !ended_; ++i) {
    if (const auto push = pushes_.due(time())) world.apply_push(*push);
    next_targets(world, controller);
    if (control_step(world, true) != StepStatus::kOk) {
      statistics_.note(Outcome::kDiverged);
      ended_ = true;
      break;
    }
    ++steps_;
    statistics_.add_control_step(world, targets_, options_.control_dt);
    ended_ = statistics_.any(options_.terminations);
  }
  return !ended_;
}

}  // namespace crossgait
