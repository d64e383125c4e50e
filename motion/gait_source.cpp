#include "motion/gait_source.h"

#include <memory>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

// The controllers' setters refuse what `choose_gait` has refused before.
void require(bool accepted) {
  if (!accepted) throw ConfigError("gait", "parameters or command", "valid values", "values that are not");
}

// A gait that walks on legs. @tparam Gait  GaitGenerator or MultiGaitController
template <typename Gait>
struct GaitOnLegs {
  Gait gait;
  LegController legs;
  std::optional<VelocityCommand> command;
  HeadingHold heading_hold;
  LegArray<Vector3> standing;
  HeadingHoldState heading = {};
};

const GaitGenerator& generator_of(const GaitGenerator& gait) { return gait; }
const GaitGenerator& generator_of(const MultiGaitController& gait) { return gait.generator(); }

template <typename Gait>
TargetSource walk_legs(Gait gait, LegController legs, const std::optional<VelocityCommand>& command,
                       const HeadingHold& heading_hold) {
  const LegArray<Vector3> standing = target_positions(generator_of(gait).targets());
  gait.set_sweep(legs.foot_sweep(standing, generator_of(gait).parameters()));
  legs.set_load_share(generator_of(gait).parameters().load_share);
  const auto own = std::make_shared<GaitOnLegs<Gait>>(
      GaitOnLegs<Gait>{std::move(gait), std::move(legs), command, heading_hold, standing});
  return {.stand =
              [own](const Terrain& terrain, const Placement& placement) {
                return own->legs.standing_state(own->standing, terrain, placement);
              },
          .hold = [own](double dt, ControlTargets& out) { solve_legs(own->legs, own->standing, dt, out); },
          .advance =
              [own](double dt, ControlTargets& out) {
                const LegArray<FootTarget>& feet = own->gait.update(dt);
                drive_legs(own->legs, generator_of(own->gait), feet, own->command, dt, out);
              },
          .look =
              [own](const RobotState& state, double dt) {
                const double turning = own->command ? own->command->yaw_rate : 0;
                own->gait.set_steering(own->heading.look(own->heading_hold, state, turning, dt));
              }};
}

}  // namespace

void drive_legs(LegController& legs, const GaitGenerator& generator, const LegArray<FootTarget>& feet,
                const std::optional<VelocityCommand>& command, double dt, ControlTargets& out) noexcept {
  legs.set_load_share(generator.effective().parameters.load_share);
  solve_legs(legs, target_positions(feet), dt, out);
  out.plan.emplace();
  for (const Leg leg : kLegs) (*out.plan)[leg] = {feet[leg].swing, feet[leg].progress};
  out.parameters = generator.parameters();
  out.limit_factor = generator.limit_factor();
  out.velocity = command ? *command : nominal_velocity(generator);
}

VelocityCommand nominal_velocity(const GaitGenerator& generator) noexcept {
  return {nominal_speed(generator.parameters()), 0, 0};
}

GaitChoice choose_gait(const std::string& gait, const std::vector<std::string>& settings,
                       const std::optional<VelocityCommand>& command, const GaitScale& scale) {
  GaitChoice choice;
  if (is_automatic(gait)) {
    if (!command)
      throw ConfigError("gait", gait, "a speed or a velocity command to choose the gait by", "none");
    choice.automatic = gait;
    choice.bands = gait == kAutomaticGait ? default_speed_bands() : guide_speed_bands();
  } else {
    choice.gait = scaled(find_gait(gait), scale);
  }
  if (command && !command->is_finite()) {
    throw ConfigError("gait", "velocity command", "finite vx, vy (m/s) and yaw rate (rad/s)",
                      fmt::format("{}, {}, {}", command->vx, command->vy, command->yaw_rate));
  }
  const auto change = [&settings](GaitParameters& parameters) {
    for (const std::string& setting : settings) assign(parameters, setting);
  };
  for (SpeedBand& band : choice.bands) {
    band.gait = scaled(band.gait, scale);
    band.below *= scale.time();
    change(band.gait.preferred);
  }
  if (choice.gait) {
    choice.parameters = choice.gait->preferred;
    change(choice.parameters);
  } else {
    choice.parameters = choice.bands.front().gait.preferred;
  }
  choice.command = command;
  return choice;
}

MultiGaitOptions multi_gait_options(const GaitChoice& choice, const GaitScale& scale) {
  MultiGaitOptions options =
      choice.automatic == kGuidesAutomaticGait ? guide_multi_gait_options() : MultiGaitOptions();
  options = scaled(std::move(options), scale);
  options.bands = choice.bands;
  return options;
}

LegArray<Vector3> target_positions(const LegArray<FootTarget>& targets) noexcept {
  LegArray<Vector3> feet;
  for (const Leg leg : kLegs) feet[leg] = targets[leg].position;
  return feet;
}

TargetSource make_gait_source(const GaitChoice& choice, std::shared_ptr<const RobotDescription> robot,
                              const GaitLayers& layers) {
  const GaitScale scale = gait_scale(*robot);
  const HeadingHold heading_hold = scaled(layers.heading_hold, scale);
  LegController legs(std::move(robot), layers.compensation);
  const LegArray<Vector3> p_BL = leg_origins(legs.kinematics());
  if (!choice.gait) {
    MultiGaitController controller(multi_gait_options(choice, scale), p_BL);
    require(!choice.command || controller.set_command(*choice.command));
    return walk_legs(std::move(controller), std::move(legs), choice.command, heading_hold);
  }
  GaitGenerator generator(*choice.gait, choice.parameters, p_BL, scaled(StepLimits(), scale));
  require(!choice.command || generator.set_command(*choice.command));
  generator.reset(GaitGenerator::Start::kStanding);
  return walk_legs(std::move(generator), std::move(legs), choice.command, heading_hold);
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
