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
    : nominal_(spec),
      world_(engine.make(spec)),
      control_dt_(control_dt),
      drive_(drive),
      loop_(*spec.robot, loop_options(control_dt)) {
  stand_up();
}

GaitInstance::GaitInstance(const Engine& engine, const GaitInstance& other, const WorldSpec& spec)
    : nominal_(other.nominal_),
      world_(engine.make(spec)),
      control_dt_(other.control_dt_),
      drive_(other.drive_),
      loop_(other.loop_) {
  world_->reset(other.world_->state());
}

std::unique_ptr<RobotInstance> GaitInstance::with_engine(const Engine& engine) const {
  return std::unique_ptr<RobotInstance>(new GaitInstance(engine, *this, world_->spec()));
}

std::unique_ptr<RobotInstance> GaitInstance::with_changes(const Engine& engine,
                                                          const std::vector<QuantityChange>& changes) const {
  return std::unique_ptr<RobotInstance>(new GaitInstance(engine, *this, changed(nominal_, changes)));
}

struct GaitInstance::Moment : Saved {
  Moment(Snapshot saved, GaitDrive driven, ClosedLoop looped)
      : world(std::move(saved)), drive(std::move(driven)), loop(std::move(looped)) {}

  Snapshot world;
  GaitDrive drive;
  ClosedLoop loop;
};

std::unique_ptr<RobotInstance::Saved> GaitInstance::save() const {
  return std::make_unique<Moment>(world_->save(), drive_, loop_);
}

void GaitInstance::restore(const Saved& saved) {
  const auto& moment = dynamic_cast<const Moment&>(saved);
  world_->restore(moment.world);
  drive_ = moment.drive;
  loop_ = moment.loop;
}

void GaitInstance::step() {
  loop_.advance(*world_, drive_, 1);
  world_->clear_wrenches();
}

std::unique_ptr<RobotInstance> GaitInstance::with_terrain(const Engine& engine,
                                                          const TerrainChoice& ground) const {
  WorldSpec spec = nominal_;
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
