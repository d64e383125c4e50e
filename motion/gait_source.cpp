#include "motion/gait_source.h"

#include <memory>

#include <fmt/format.h>

#include "motion/gait_walker.h"
#include "physics/core/error.h"

namespace crossgait {
namespace {

// The controllers' setters refuse what `choose_gait` has refused before.
void require(bool accepted) {
  if (!accepted) throw ConfigError("gait", "parameters or command", "valid values", "values that are not");
}

// One that is about to begin.
template <typename Generator>
ControllerPtr walker(Generator generator, FootTargetTracker legs, const HeadingHold& heading_hold,
                     const std::optional<VelocityCommand>& command) {
  const auto made =
      std::make_shared<GaitWalker<Generator>>(std::move(generator), std::move(legs), heading_hold, command);
  made->begin();
  return made;
}

// Feet from anywhere on legs.
class FeetController final : public Controller {
 public:
  FeetController(FootTargets feet, FootTargetTracker legs)
      : feet_(std::move(feet)), legs_(std::move(legs)), standing_(feet_(0)) {}

  RobotState initial_state(const Terrain& terrain, const Placement& placement) const override {
    return legs_.standing_state(standing_, terrain, placement);
  }
  void hold_pose(double dt, ControlTargets& out) override { solve_legs(legs_, standing_, dt, out); }
  void advance(double dt, ControlTargets& out) override { solve_legs(legs_, feet_(dt), dt, out); }

 private:
  FootTargets feet_;
  FootTargetTracker legs_;
  LegArray<Vector3> standing_;
};

}  // namespace

void drive_legs(FootTargetTracker& legs, const GaitGenerator& generator, const LegArray<FootTarget>& feet,
                const std::optional<VelocityCommand>& command, double dt, ControlTargets& out) noexcept {
  legs.set_load_share(generator.effective().parameters.load_share);
  solve_legs(legs, target_positions(feet), dt, out);
  out.contact_schedule.emplace();
  for (const Leg leg : kLegs) (*out.contact_schedule)[leg] = {feet[leg].swing, feet[leg].progress};
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

ControllerPtr make_gait_controller(const GaitChoice& choice, const WorldSpec& world,
                                   const GaitLayers& layers) {
  const GaitScale scale = gait_scale(*world.robot);
  const HeadingHold heading_hold = scaled(layers.heading_hold, scale);
  FootTargetTracker legs(world.robot, layers.compensation, weight_per_mass(world));
  const LegArray<Vector3> p_BL = leg_origins(legs.kinematics());
  if (!choice.gait) {
    MultiGaitController controller(multi_gait_options(choice, scale), p_BL);
    require(!choice.command || controller.set_command(*choice.command));
    return walker(std::move(controller), std::move(legs), heading_hold, choice.command);
  }
  GaitGenerator generator(*choice.gait, choice.parameters, p_BL, scaled(StepLimits(), scale));
  require(!choice.command || generator.set_command(*choice.command));
  generator.reset(GaitGenerator::Start::kStanding);
  return walker(std::move(generator), std::move(legs), heading_hold, choice.command);
}

ControllerPtr make_feet_controller(FootTargets feet, const WorldSpec& world,
                                   const ServoCompensation& compensation) {
  return std::make_shared<FeetController>(
      std::move(feet), FootTargetTracker(world.robot, compensation, weight_per_mass(world)));
}

}  // namespace crossgait
