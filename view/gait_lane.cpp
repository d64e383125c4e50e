#include "view/gait_lane.h"

#include <utility>

namespace crossgait {
namespace {

ClosedLoop::Options loop_options(double control_dt) {
  return {.control_dt = control_dt, .ends = OutcomeSet::of_walks().add(Outcome::kLeftTerrain)};
}

}  // namespace

GaitLane::GaitLane(const Engine& engine, const WorldSpec& spec, const GaitDrive& drive, double control_dt)
    : world_(engine.make(spec)),
      control_dt_(control_dt),
      drive_(drive),
      loop_(*spec.robot, loop_options(control_dt)) {
  stand_up();
}

GaitLane::GaitLane(const Engine& engine, const GaitLane& other)
    : world_(engine.make(other.world_->spec())),
      control_dt_(other.control_dt_),
      drive_(other.drive_),
      loop_(other.loop_) {
  world_->reset(other.world_->state());
}

std::unique_ptr<Lane> GaitLane::in(const Engine& engine) const {
  return std::unique_ptr<Lane>(new GaitLane(engine, *this));
}

std::unique_ptr<Lane> GaitLane::on(const Engine& engine, const Ground& ground) const {
  WorldSpec spec = world_->spec();
  spec.terrain = make_terrain(ground.terrain, ground.seed);
  return std::make_unique<GaitLane>(engine, spec, drive_, control_dt_);
}

void GaitLane::stand_up() {
  GaitDrive standing = drive_;
  standing.restart();  // may throw: the lane is as it was then
  drive_ = std::move(standing);
  loop_.start(*world_, drive_);
}

}  // namespace crossgait
