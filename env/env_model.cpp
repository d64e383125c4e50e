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

AdaptiveGaitController controller_of(const EnvConfig& config, const RobotDescription& robot) {
  AdaptiveGaitOptions options;
  options.parameters = config.adapt;
  options.ranges = config.adaptation;
  options.initial = config.parameters;
  options.residual_scale = config.residual_scale;
  return {find_gait(config.gait), options, leg_origins(robot)};
}

PolicyInterface make_interface(const EnvConfig& config, const RobotDescription& robot,
                               std::span<const ParameterRow> parameters) {
  PolicyInterface interface { {}, action_layout(parameters), config.policy_dt, config.adaptation };
  ObservationContext context{{}, parameters, interface.action, config.parameters};
  for (const int i : robot.actuated_joints()) context.actuated_joints.push_back(robot.joint(i).name);
  for (const std::string& name : config.observation)
    find_observation_block(name).describe(context, interface.observation);
  return interface;
}

}  // namespace

std::shared_ptr<const EnvModel> EnvModel::make(const EnvConfig& config) {
  config.validate();
  const WorldSpec world = nominal_world(config);
  const AdaptiveGaitController controller = controller_of(config, *world.robot);
  EnvModel model{.config = config,
                 .world = world,
                 .interface = make_interface(config, *world.robot, controller.adapted()),
                 .blocks = {},
                 .servos = world.robot->actuated_joints(),
                 .foot_kinematics = FootKinematics(*world.robot),
                 .layout = {},
                 .policy_steps = step_count(config.policy_dt, config.control_dt),
                 .max_steps = step_count(config.episode_seconds, config.policy_dt)};
  model.layout = layout_hash(model.interface.observation, model.interface.action);
  for (const std::string& name : config.observation) model.blocks.push_back(&find_observation_block(name));
  return std::make_shared<const EnvModel>(std::move(model));
}

AdaptiveGaitController EnvModel::make_controller() const { return controller_of(config, *world.robot); }

}  // namespace crossgait
