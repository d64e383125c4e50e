#include "crossgait/env/env_model.h"

#include "crossgait/env/gait_source.h"
#include "crossgait/env/time_steps.h"
#include "crossgait/physics/data_path.h"

namespace crossgait {
namespace {

WorldSpec nominal_world(const EnvConfig& config) {
  WorldSpec world;
  world.robot = config.at_its_place(config.robot, [&] {
    return std::make_shared<const RobotDescription>(load_robot(find_robot(config.robot)));
  });
  world.terrain =
      config.at_its_place(config.terrain, [&] { return make_terrain(config.terrain, config.terrain_seed); });
  world.physics_dt = config.physics_dt;
  world.contact.friction = config.friction;
  return world;
}

PolicyInterface make_interface(const EnvModel& model, std::span<const ParameterRow> parameters) {
  const RobotDescription& robot = *model.world.robot;
  PolicyInterface interface { {}, action_layout(parameters), model.config.policy_dt, model.adaptation };
  ObservationContext context{{}, parameters, interface.action, model.parameters};
  for (const int i : robot.actuated_joints()) context.actuated_joints.push_back(robot.joint(i).name);
  for (const std::string& name : model.config.observation)
    find_observation_block(name).describe(context, interface.observation);
  return interface;
}

}  // namespace

std::shared_ptr<const EnvModel> EnvModel::make(const EnvConfig& config) {
  config.validate();
  const WorldSpec world = nominal_world(config);
  const GaitScale scale = gait_scale(*world.robot);
  EnvModel model{
      .config = config,
      .world = world,
      .parameters = config.parameters.over(scaled(find_gait(config.gait), scale).preferred),
      .adaptation = scaled(config.adaptation, scale),
      .residual_scale = config.residual_scale.value_or(AdaptiveGaitOptions{}.residual_scale * scale.length),
      .heading_hold = config.heading_hold ? scaled(HeadingHold(), scale) : HeadingHold::none(),
      .interface = {},
      .blocks = {},
      .servos = world.robot->actuated_joints(),
      .foot_kinematics = FootKinematics(*world.robot),
      .layout = {},
      .policy_steps = step_count(config.policy_dt, config.control_dt),
      .max_steps = step_count(config.episode_seconds, config.policy_dt)};
  model.adaptation.validate("environment");
  const AdaptiveGaitController controller = model.make_controller();
  model.interface = make_interface(model, controller.adapted());
  model.layout = layout_hash(model.interface.observation, model.interface.action);
  for (const std::string& name : config.observation) model.blocks.push_back(&find_observation_block(name));
  return std::make_shared<const EnvModel>(std::move(model));
}

EnvConfig EnvModel::stated() const {
  EnvConfig whole = config;
  whole.parameters = GaitSettings::all(parameters);
  whole.residual_scale = residual_scale;
  whole.adaptation = adaptation;
  return whole;
}

AdaptiveGaitController EnvModel::make_controller() const {
  const GaitScale scale = gait_scale(*world.robot);
  AdaptiveGaitOptions options;
  options.parameters = config.adapt;
  options.ranges = adaptation;
  options.initial = parameters;
  options.residual_scale = residual_scale;
  options.limits = scaled(options.limits, scale);
  return {find_gait(config.gait), options, leg_origins(*world.robot)};
}

}  // namespace crossgait
