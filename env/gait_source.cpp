#include "crossgait/env/gait_source.h"

#include <memory>

#include <fmt/format.h>

#include "crossgait/gait/multi_gait_controller.h"
#include "crossgait/physics/error.h"

namespace crossgait {
namespace {

// The controllers' setters refuse what `choose_gait` has refused before.
void require(bool accepted) {
  if (!accepted) throw ConfigError("gait", "parameters or command", "valid values", "values that are not");
}

}  // namespace

GaitChoice choose_gait(const std::string& gait, const std::vector<std::string>& settings,
                       const std::optional<VelocityCommand>& command) {
  GaitChoice choice;
  if (gait != kAutomaticGait) {
    choice.gait = find_gait(gait);
    choice.parameters = choice.gait->preferred;
  } else if (!command) {
    throw ConfigError("gait", gait, "a speed or a velocity command to choose the gait by", "none");
  } else {
    choice.parameters = find_gait("trot").preferred;  // the middle one's serve all
  }
  if (command && !command->is_finite()) {
    throw ConfigError("gait", "velocity command", "finite vx, vy (m/s) and yaw rate (rad/s)",
                      fmt::format("{}, {}, {}", command->vx, command->vy, command->yaw_rate));
  }
  for (const std::string& setting : settings) assign(choice.parameters, setting);
  choice.command = command;
  return choice;
}

LegArray<Vector3> target_positions(const LegArray<FootTarget>& targets) noexcept {
  LegArray<Vector3> feet;
  for (const Leg leg : kLegs) feet[leg] = targets[leg].position;
  return feet;
}

LegArray<Vector3> leg_origins(const RobotDescription& robot) {
  LegArray<Vector3> p_BL;
  for (const Leg leg : kLegs) p_BL[leg] = five_bar_geometry(robot, leg).p_BL;
  return p_BL;
}

GaitSource make_gait_source(const GaitChoice& choice, const RobotDescription& robot) {
  const LegArray<Vector3> p_BL = leg_origins(robot);
  if (!choice.gait) {
    MultiGaitOptions options;
    options.parameters = choice.parameters;
    const auto controller = std::make_shared<MultiGaitController>(options, p_BL);
    require(!choice.command || controller->set_command(*choice.command));
    return {[controller](double dt) { return target_positions(controller->update(dt)); },
            [controller]() -> const GaitGenerator& { return controller->generator(); }};
  }
  const auto generator = std::make_shared<GaitGenerator>(*choice.gait, choice.parameters, p_BL);
  require(!choice.command || generator->set_command(*choice.command));
  generator->reset(GaitGenerator::Start::kStanding);
  return {[generator](double dt) { return target_positions(generator->update(dt)); },
          [generator]() -> const GaitGenerator& { return *generator; }};
}

}  // namespace crossgait
