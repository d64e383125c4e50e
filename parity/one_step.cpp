#include "parity/one_step.h"

#include <algorithm>

namespace crossgait {

OneStepCheck::OneStepCheck(std::unique_ptr<PhysicsBackend> world, int substeps)
    : world_(std::move(world)), substeps_(substeps) {
  for (const Body& body : world_->robot().bodies) {
    const Joint& joint = body.joint;
    has_memory_ = has_memory_ || joint.delay > 0 || joint.lag > 0 || joint.sensor_noise > 0;
  }
}

void OneStepCheck::add(const PhysicsBackend& reference, const TraceSample& sample) {
  if (begun_) {
    world_->reset(before_);
    if (has_memory_) {
      Snapshot snapshot = world_->save();
      snapshot.drives = drives_;
      world_->restore(snapshot);
    }
    const bool diverged = world_->step(sample.targets, substeps_) != StepStatus::kOk;
    PairDifference apart;
    TraceSample other = sample;
    other.state = diverged ? before_ : world_->state();
    per_step_ += compare_samples(sample, other, apart);
    carried_ += per_step_;
    const double before = difference_.largest();
    difference_.position_m = std::max(difference_.position_m, apart.max_position_difference_m);
    difference_.joint_rad = std::max(difference_.joint_rad, apart.max_joint_difference_rad);
    difference_.attitude_rad = std::max(difference_.attitude_rad, apart.max_attitude_difference_rad);
    if (difference_.largest() > before) difference_.at_s = sample.state.time;
    ++difference_.steps;
  }
  remember(reference);
}

void OneStepCheck::remember(const PhysicsBackend& reference) {
  before_ = reference.state();
  if (has_memory_) drives_ = reference.save().drives;
  begun_ = true;
}

}  // namespace crossgait
