#include "crossgait/view/lane.h"

#include <utility>

namespace crossgait {
namespace {

ClosedLoop::Options loop_options(double control_dt) {
  // A robot that fell may get up again; off the edge of its ground it would fall for ever.
  return {.control_dt = control_dt, .ends = OutcomeSet::of_walks().add(Outcome::kLeftTerrain)};
}

}  // namespace

Lane::Lane(const Engine& engine, const WorldSpec& spec, const GaitDrive& drive, double control_dt)
    : world_(engine.make(spec)),
      drive_(drive),
      loop_(*spec.robot, loop_options(control_dt)),
      source_(source()) {
  stand_up();
}

Lane::Lane(const Engine& engine, const Lane& other)
    : world_(engine.make(other.world_->spec())), drive_(other.drive_), loop_(other.loop_), source_(source()) {
  world_->reset(other.world_->state());
}

TargetSource Lane::source() {
  return {.stand = [this](const Terrain& terrain,
                          const Placement& placement) { return drive_.stand(terrain, placement); },
          .hold = [this](double dt, ControlTargets& out) { drive_.hold(dt, out); },
          .advance = [this](double dt, ControlTargets& out) { drive_.advance(dt, out); },
          .look = [this](const RobotState& state, double dt) { drive_.look(state, dt); }};
}

bool Lane::step() {
  if (loop_.ended()) return false;
  loop_.advance(*world_, source_, 1);
  // A step that diverged has nothing to show: the world still holds the state before it.
  return !loop_.statistics().has(Outcome::kDiverged);
}

void Lane::stand_up() {
  GaitDrive standing = drive_;
  standing.restart();  // may throw: the lane is as it was then
  drive_ = std::move(standing);
  loop_.start(*world_, source_);
}

}  // namespace crossgait
