#include "view/gait_instance.h"

#include <utility>

namespace crossgait {
namespace {

ClosedLoop::Options loop_options(double control_dt) {
  return {.control_dt = control_dt, .terminations = OutcomeSet::of_walks()};
}

}  // namespace

GaitInstance::GaitInstance(const Engine& engine, const WorldSpec& spec, const GaitDrive& drive,
                           double control_dt)
    : world_(engine.make(spec)),
      control_dt_(control_dt),
      drive_(drive),
      loop_(*spec.robot, loop_options(control_dt)) {
  stand_up();
}

GaitInstance::GaitInstance(const Engine& engine, const GaitInstance& other)
    : world_(engine.make(other.world_->spec())),
      control_dt_(other.control_dt_),
      drive_(other.drive_),
      loop_(other.loop_) {
  world_->reset(other.world_->state());
}

std::unique_ptr<RobotInstance> GaitInstance::with_engine(const Engine& engine) const {
  return std::unique_ptr<RobotInstance>(new GaitInstance(engine, *this));
}

std::unique_ptr<RobotInstance> GaitInstance::with_terrain(const Engine& engine,
                                                          const TerrainChoice& ground) const {
  WorldSpec spec = world_->spec();
  spec.terrain = make_terrain(ground.terrain, ground.seed);
  return std::make_unique<GaitInstance>(engine, spec, drive_, control_dt_);
}

void GaitInstance::stand_up() {
  GaitDrive standing = drive_;
  standing.restart();  // may throw: the instance is as it was then
  drive_ = std::move(standing);
  loop_.start(*world_, drive_);
}

}  // namespace crossgait
