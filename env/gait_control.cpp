#include "env/gait_control.h"

namespace crossgait {

GaitControl::GaitControl(const EnvModel& model)
    : GaitWalker(model.make_controller(),
                 FootTargetTracker(model.world.robot, {}, weight_per_mass(model.world)), model.heading_hold) {
}

void GaitControl::restart(const std::optional<VelocityCommand>& command) {
  follow(command);
  GaitGenerator& generator = mutable_generator().generator();
  if (command) {
    static_cast<void>(generator.set_command(*command));  // finite: validated
  } else {
    generator.clear_command();
  }
  generator.set_steering(0);
  mutable_generator().reset(GaitGenerator::Start::kStanding);
  begin();
}

void GaitControl::set_command(const VelocityCommand& command) noexcept {
  static_cast<void>(mutable_generator().generator().set_command(command));
  follow(command);
}

}  // namespace crossgait
