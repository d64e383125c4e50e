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

// A gait's targets on legs. @param update advances the gait @param generator the one that moves the feet
template <typename Update, typename Generator>
TargetSource walk_legs(LegController legs, const std::optional<VelocityCommand>& command, Update update,
                       Generator generator) {
  const auto own = std::make_shared<LegController>(std::move(legs));
  const LegArray<Vector3> standing = target_positions(update(0));
  const auto stand = [own, standing](const Terrain& terrain, const Placement& placement) {
    return own->standing_state(standing, terrain, placement);
  };
  const auto hold = [own, standing](double dt, ControlTargets& out) { solve_legs(*own, standing, dt, out); };
  const auto advance = [own, command, update, generator](double dt, ControlTargets& out) {
    const LegArray<FootTarget>& feet = update(dt);
    solve_legs(*own, target_positions(feet), dt, out);
    describe_plan(generator(), feet, command, out);
  };
  return {stand, hold, advance};
}

}  // namespace

void describe_plan(const GaitGenerator& generator, const LegArray<FootTarget>& feet,
                   const std::optional<VelocityCommand>& command, ControlTargets& out) noexcept {
  out.plan.emplace();
  for (const Leg leg : kLegs) (*out.plan)[leg] = {feet[leg].swing, feet[leg].progress};
  out.parameters = generator.parameters();
  out.limit_factor = generator.limit_factor();
  out.velocity = command ? *command : nominal_velocity(generator);
}

VelocityCommand nominal_velocity(const GaitGenerator& generator) noexcept {
  const GaitParameters& p = generator.parameters();
  double stance = 0;
  for (const Leg leg : kLegs) stance += generator.duty()[leg] * p.cycle_time / kLegCount;
  return {p.step_length / stance, 0, 0};
}

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

TargetSource make_gait_source(const GaitChoice& choice, std::shared_ptr<const RobotDescription> robot,
                              const ServoCompensation& compensation) {
  const LegArray<Vector3> p_BL = leg_origins(*robot);
  if (!choice.gait) {
    MultiGaitOptions options;
    options.parameters = choice.parameters;
    const auto controller = std::make_shared<MultiGaitController>(options, p_BL);
    require(!choice.command || controller->set_command(*choice.command));
    return walk_legs(
        LegController(std::move(robot), compensation), choice.command,
        [controller](double dt) -> const LegArray<FootTarget>& { return controller->update(dt); },
        [controller]() -> const GaitGenerator& { return controller->generator(); });
  }
  const auto generator = std::make_shared<GaitGenerator>(*choice.gait, choice.parameters, p_BL);
  require(!choice.command || generator->set_command(*choice.command));
  generator->reset(GaitGenerator::Start::kStanding);
  return walk_legs(
      LegController(std::move(robot), compensation), choice.command,
      [generator](double dt) -> const LegArray<FootTarget>& { return generator->update(dt); },
      [generator]() -> const GaitGenerator& { return *generator; });
}

TargetSource make_feet_source(FootTargets feet, std::shared_ptr<const RobotDescription> robot,
                              const ServoCompensation& compensation) {
  struct Feet {
    FootTargets targets;
    LegController legs;
    LegArray<Vector3> standing;
  };
  const LegArray<Vector3> standing = feet(0);
  const auto own =
      std::make_shared<Feet>(Feet{std::move(feet), LegController(std::move(robot), compensation), standing});
  return {[own](const Terrain& terrain, const Placement& placement) {
            return own->legs.standing_state(own->standing, terrain, placement);
          },
          [own](double dt, ControlTargets& out) { solve_legs(own->legs, own->standing, dt, out); },
          [own](double dt, ControlTargets& out) { solve_legs(own->legs, own->targets(dt), dt, out); }};
}

}  // namespace crossgait
