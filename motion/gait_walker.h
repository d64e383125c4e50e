// A gait, the legs that follow it and the heading that it keeps.
#pragma once

#include <optional>
#include <utility>

#include "gait/adaptive_gait_controller.h"
#include "gait/multi_gait_controller.h"
#include "motion/controller.h"
#include "motion/foot_target_tracker.h"
#include "motion/gait_source.h"
#include "motion/heading_hold.h"

namespace crossgait {

/// Returns the generator that makes the steps, whichever of the three stands around it.
inline const GaitGenerator& generator_of(const GaitGenerator& gait) noexcept { return gait; }
inline const GaitGenerator& generator_of(const MultiGaitController& gait) noexcept {
  return gait.generator();
}
inline const GaitGenerator& generator_of(const AdaptiveGaitController& gait) noexcept {
  return gait.generator();
}

/// Returns where the feet are to be, with whatever comes on top of the steps.
template <typename Generator>
const LegArray<FootTarget>& feet_of(const Generator& gait) noexcept {
  return generator_of(gait).targets();
}
inline const LegArray<FootTarget>& feet_of(const AdaptiveGaitController& gait) noexcept {
  return gait.targets();
}

/// Returns what takes sweep and steering.
inline GaitGenerator& steered(GaitGenerator& gait) noexcept { return gait; }
inline MultiGaitController& steered(MultiGaitController& gait) noexcept { return gait; }
inline GaitGenerator& steered(AdaptiveGaitController& gait) noexcept { return gait.generator(); }

/// Walks a gait: foot targets, leg kinematics and heading hold as one controller. A value: a copy goes on
/// from there. @tparam Generator  GaitGenerator, MultiGaitController or AdaptiveGaitController
template <typename Generator>
class GaitWalker : public Controller {
 public:
  /// @param command  that the generator follows, if any: without one it takes steps of step_length
  GaitWalker(Generator generator, FootTargetTracker legs, const HeadingHold& heading_hold,
             const std::optional<VelocityCommand>& command = {})
      : generator_(std::move(generator)),
        legs_(std::move(legs)),
        hold_heading_(heading_hold),
        command_(command) {}

  /// Begins a motion: the generator's first targets are where the robot stands, and nothing is remembered. To
  /// be called before anything else. @throws ConfigError if they are out of reach
  void begin() {
    legs_.restart();
    heading_.restart();
    // Standing is the gait's first target held; walking begins after it.
    standing_ = target_positions(feet_of(generator_));
    steered(generator_)
        .set_rolling_correction(legs_.rolling_correction(standing_, generator_of(generator_).parameters()));
    legs_.set_load_share(generator_of(generator_).parameters().load_share);
  }

  RobotState initial_state(const Terrain& terrain, const Placement& placement) const override {
    return legs_.standing_state(standing_, terrain, placement);
  }
  void hold_pose(double dt, ControlTargets& out) noexcept override { solve_legs(legs_, standing_, dt, out); }
  void observe(const RobotState& state, double dt) noexcept override {
    const double turning = command_ ? command_->yaw_rate : 0;
    steered(generator_).set_steering(heading_.update(hold_heading_, state, turning, dt));
  }
  void advance(double dt, ControlTargets& out) noexcept override {
    const LegArray<FootTarget>& feet = generator_.update(dt);
    drive_legs(legs_, generator_of(generator_), feet, command_, dt, out);
  }

  const Generator& generator() const noexcept { return generator_; }

 protected:
  Generator& mutable_generator() noexcept { return generator_; }
  const FootTargetTracker& legs() const noexcept { return legs_; }
  /// Notes what the generator has been told to follow.
  void follow(const std::optional<VelocityCommand>& command) noexcept { command_ = command; }

 private:
  Generator generator_;
  FootTargetTracker legs_;
  HeadingHold hold_heading_;
  HeadingHoldState heading_;
  std::optional<VelocityCommand> command_;
  LegArray<Vector3> standing_{};  // feet before the first step, in the leg frames, m
};

}  // namespace crossgait
