#include "env/env_model.h"

#include <algorithm>

#include "motion/gait_source.h"
#include "motion/time_steps.h"
#include "physics/robot/drives.h"

namespace crossgait {
namespace {

WorldSpec nominal_world(const LoadedEnv& loaded) {
  const EnvConfig& config = loaded.config;
  WorldSpec world;
  world.robot = loaded.robot;
  if (!config.servos.empty()) {
    auto robot = std::make_shared<RobotDescription>(*world.robot);
    config.servos.apply(*robot, config.source);
    RobotDescription named = *robot;  // what is wrong with a delay is said of the file that set it
    named.source = config.source;
    static_cast<void>(Drives(named, config.physics_dt));
    world.robot = std::move(robot);
  }
  world.terrain =
      config.at_its_place(config.terrain, [&] { return loaded.ground.make(config.terrain_seed); });
  world.physics_dt = config.physics_dt;
  world.contact = simulated_contact(world.robot->contact, config.contact, world.physics_dt, config.source);
  return world;
}

std::vector<std::string> names_of(const std::vector<int>& joints, const RobotDescription& robot) {
  std::vector<std::string> names;
  for (const int i : joints) names.push_back(robot.joint(i).name);
  return names;
}

Observer make_observer(const EnvModel& model, const ObservationContext& context) {
  const EnvConfig& c = model.config;
  return {c.observation, context, c.policy_dt, c.control_dt};
}

void describe_gait(EnvModel& model) {
  const AdaptiveGaitController controller = model.make_controller();
  model.interface.action = action_layout(controller.adapted());
  model.interface.adaptation = model.adaptation;
  model.observer = make_observer(model, {.joints = names_of(model.joints.observed, *model.world.robot),
                                         .home = model.joints.observed_home,
                                         .parameters = controller.adapted(),
                                         .action = model.interface.action,
                                         .initial = model.parameters,
                                         .settings = model.config.observing});
}

// Joints without servos have no targets to be seen, and a network counts time in the steps of its training.
void check_joints(const EnvModel& model) {
  const EnvConfig& c = model.config;
  const std::vector<Eigen::Index>& slots = model.joints.observed_slots;
  const bool targets = std::any_of(c.observation.begin(), c.observation.end(),
                                   [](const ObservationTerm& term) { return term.block == "joint_targets"; });
  if (const auto passive = std::find(slots.begin(), slots.end(), -1); targets && passive != slots.end()) {
    const auto joint = model.joints.observed[static_cast<std::size_t>(passive - slots.begin())];
    throw ConfigError(c.source, "observation", "joints.observed of servos alone, beside joint_targets",
                      model.world.robot->joint(joint).name);
  }
  if (model.actuator != nullptr) model.actuator->check_step(c.physics_dt, c.source);
}

void describe_joints(EnvModel& model) {
  check_joints(model);
  const std::vector<std::string> names = names_of(model.joints.servos, *model.world.robot);
  model.interface.action = joint_action_layout(names, model.joints, model.config.joints.limit);
  model.observer = make_observer(model, {.joints = names_of(model.joints.observed, *model.world.robot),
                                         .home = model.joints.observed_home,
                                         .parameters = {},
                                         .action = model.interface.action,
                                         .settings = model.config.observing});
}

}  // namespace

std::shared_ptr<const EnvModel> EnvModel::make(const LoadedEnv& loaded) {
  const EnvConfig& config = loaded.config;
  config.validate(config.source);
  const WorldSpec world = nominal_world(loaded);
  const GaitScale scale = gait_scale(*world.robot);
  EnvModel model{
      .config = config,
      .robot = loaded.robot,
      .ground = loaded.ground,
      .world = world,
      .parameters = config.parameters.over(scaled(find_gait(config.gait), scale).preferred),
      .adaptation = scaled(config.adaptation, scale),
      .residual_scale = config.residual_scale.value_or(AdaptiveGaitOptions{}.residual_scale * scale.length),
      .heading_hold = config.heading_hold ? scaled(HeadingHold(), scale) : HeadingHold::none(),
      .size = scale.length,
      .joints = JointActionTable::make(config.joints, *world.robot, config.source),
      .actuator = loaded.actuator,
      .interface = {.observation = {}, .action = {}, .policy_dt = config.policy_dt},
      .observer = {},
      .foot_kinematics = FootKinematics(*world.robot),
      .action_bounds = {},
      .layout = {},
      .policy_steps = step_count(config.policy_dt, config.control_dt),
      .max_steps = step_count(config.episode_seconds, config.policy_dt)};
  model.adaptation.validate(config.source);
  if (config.action == ActionKind::kGait) {
    describe_gait(model);
  } else {
    describe_joints(model);
  }
  model.interface.observation = model.observer.layout();
  if (config.extension != nullptr) {
    const std::vector<LayoutEntry>& added = config.extension->observation.entries;
    std::vector<LayoutEntry>& entries = model.interface.observation.entries;
    entries.insert(entries.end(), added.begin(), added.end());
  }
  for (const LayoutEntry& entry : model.interface.action.entries)
    model.action_bounds.emplace_back(entry.min, entry.max);
  model.layout = layout_hash(model.interface.observation, model.interface.action);
  return std::make_shared<const EnvModel>(std::move(model));
}

LoadedEnv EnvModel::loaded() const {
  LoadedEnv own(config, robot, actuator);
  own.ground = ground;
  return own;
}

EnvConfig EnvModel::resolved() const {
  EnvConfig whole = config;
  whole.parameters = GaitSettings::all(parameters);
  whole.residual_scale = residual_scale;
  whole.contact = all_settings(world.contact);
  whole.adaptation = adaptation;
  whole.joints.order = names_of(joints.servos, *world.robot);
  for (std::size_t i = 0; i < joints.servos.size(); ++i) {
    whole.joints.home.by_name[whole.joints.order[i]] = joints.home[i];
    whole.joints.scale.by_name[whole.joints.order[i]] = joints.scale[i];
  }
  whole.joints.home.all = whole.joints.scale.all = std::nullopt;
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
