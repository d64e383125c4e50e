#include "env/gait_control.h"

#include "motion/gait_source.h"

namespace crossgait {

GaitControl::GaitControl(const EnvModel& model)
    : controller_(model.make_controller()), legs_(model.world.robot), hold_heading_(model.heading_hold) {}

void GaitControl::restart(const std::optional<VelocityCommand>& command) {
  command_ = command;
  if (command) {
    static_cast<void>(controller_.generator().set_command(*command));  // finite: validated
  } else {
    controller_.generator().clear_command();
  }
  controller_.generator().set_steering(0);
  controller_.reset(GaitGenerator::Start::kStanding);
  legs_.restart();
  heading_.restart();
  // Standing is the gait's first target held; walking begins after it.
  standing_ = target_positions(controller_.targets());
  controller_.generator().set_sweep(legs_.foot_sweep(standing_, controller_.parameters()));
  legs_.set_load_share(controller_.parameters().load_share);
}

void GaitControl::set_command(const VelocityCommand& command) noexcept {
  static_cast<void>(controller_.generator().set_command(command));
  command_ = command;
}

void GaitControl::look(const RobotState& state, double dt) noexcept {
  const double turning = command_ ? command_->yaw_rate : 0;
  controller_.generator().set_steering(heading_.look(hold_heading_, state, turning, dt));
}

void GaitControl::advance(double dt, ControlTargets& out) noexcept {
  const LegArray<FootTarget>& feet = controller_.update(dt);
  drive_legs(legs_, controller_.generator(), feet, command_, dt, out);
}

}  // namespace crossgait
