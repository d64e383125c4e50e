#include "crossgait/env/adaptive_gait_env.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "crossgait/env/check_size.h"
#include "crossgait/env/gait_source.h"
#include "crossgait/env/time_steps.h"
#include "crossgait/physics/data_path.h"
#include "crossgait/physics/error.h"

namespace crossgait {
namespace {

constexpr double kDegrees = 180 / M_PI;

WorldSpec nominal_world(const EnvConfig& config) {
  config.validate();
  WorldSpec world;
  world.robot = std::make_shared<const RobotDescription>(load_robot(find_robot(config.robot)));
  world.terrain = make_terrain(config.terrain, config.terrain_seed);
  world.physics_dt = config.physics_dt;
  world.contact.friction = config.friction;
  return world;
}

std::vector<const ObservationBlock*> find_blocks(const std::vector<std::string>& names) {
  std::vector<const ObservationBlock*> blocks;
  blocks.reserve(names.size());
  for (const std::string& name : names) blocks.push_back(&find_observation_block(name));
  return blocks;
}

PolicyInterface make_interface(const EnvConfig& config, const RobotDescription& robot,
                               std::span<const ParameterRow* const> parameters) {
  PolicyInterface interface { {}, action_layout(parameters), config.policy_dt };
  ObservationContext context{{}, parameters, interface.action};
  for (const int i : robot.actuated_joints()) context.actuated_joints.push_back(robot.joint(i).name);
  for (const std::string& name : config.observation)
    find_observation_block(name).describe(context, interface.observation);
  return interface;
}

constexpr std::string_view kSource = "environment";

// Components of a horizontal vector in a frame turned by `yaw`; z as it is.
Vector3 in_heading(const Vector3& v, double yaw) noexcept {
  const double c = std::cos(yaw), s = std::sin(yaw);
  return {c * v.x() + s * v.y(), c * v.y() - s * v.x(), v.z()};
}

}  // namespace

AdaptiveGaitEnv::AdaptiveGaitEnv(const EnvConfig& config, Engine engine)
    : config_(config),
      engine_(std::move(engine)),
      nominal_(nominal_world(config_)),
      blocks_(find_blocks(config_.observation)),
      servos_(nominal_.robot->actuated_joints()),
      substeps_(step_count(config_.control_dt, config_.physics_dt)),
      max_steps_(step_count(config_.episode_seconds, config_.policy_dt)),
      foot_kinematics_(*nominal_.robot),
      episode_(make_episode()) {
  interface_ = make_interface(config_, *nominal_.robot, episode_.controller.adapted());
  episode_.action.assign(action_size(), 0);
  episode_.last_action = episode_.action;
  if (!config_.randomisation.changes_world()) backend_ = engine_.make(nominal_);
  std::vector<double> observation(observation_size());
  reset(0, observation);
}

AdaptiveGaitEnv::Episode AdaptiveGaitEnv::make_episode() const {
  AdaptiveGaitOptions options;
  options.parameters = config_.adapt;
  options.initial = config_.parameters;
  options.residual_scale = config_.residual_scale;
  Episode episode{nominal_.robot,
                  AdaptiveGaitController(find_gait(config_.gait), options, leg_origins(*nominal_.robot)),
                  LegController(*nominal_.robot)};
  episode.parameters.assign(episode.controller.adapted().size(), 0);
  episode.last_parameters = episode.parameters;
  return episode;
}

WorldSpec AdaptiveGaitEnv::draw_world() {
  WorldSpec world = randomised_world(nominal_, config_.randomisation, episode_.draw, episode_.random);
  if (config_.randomisation.is_on(Randomised::kTerrainSeed)) {
    const auto seed = static_cast<std::uint64_t>(episode_.draw[Randomised::kTerrainSeed]);
    world.terrain = make_terrain(config_.terrain, seed);
  }
  return world;
}

void AdaptiveGaitEnv::place_robot(const LegArray<Vector3>& feet) {
  const RandomDraw& draw = episode_.draw;
  const LegController::Placement placement{draw[Randomised::kStartX], draw[Randomised::kStartY],
                                           draw[Randomised::kStartRoll], draw[Randomised::kStartPitch],
                                           draw[Randomised::kStartYaw]};
  const Terrain& terrain = backend_->spec().terrain;
  if (!terrain.contains(placement.x, placement.y)) {
    throw ConfigError(kSource, "start_x, start_y", fmt::format("a place on {}", terrain.name()),
                      fmt::format("({:g}, {:g}) m", placement.x, placement.y));
  }
  backend_->reset(episode_.legs.standing_state(feet, terrain, placement));
}

void AdaptiveGaitEnv::reset(std::uint64_t seed, std::span<double> observation) {
  check_size(kSource, "observation", observation.size(), observation_size());
  Episode& e = episode_;
  e.random = Random(seed);
  e.draw = draw(config_.randomisation, e.random);
  if (config_.randomisation.changes_world()) backend_ = engine_.make(draw_world());

  if (config_.command) {
    static_cast<void>(e.controller.generator().set_command(*config_.command));  // finite: validated
  } else {
    e.controller.generator().clear_command();
  }
  e.command = config_.command.value_or(VelocityCommand{});
  e.controller.reset(GaitGenerator::Start::kStanding);
  e.legs.restart();
  e.steps = 0;
  e.result = {};
  e.info = {};
  std::fill(e.action.begin(), e.action.end(), 0.0);

  // Standing is the gait's first target held; walking begins after it, part of a cycle if so drawn.
  const LegArray<Vector3> feet = target_positions(e.controller.targets());
  place_robot(feet);
  StepStatus status = StepStatus::kOk;
  const int settling = step_count(config_.settle_seconds, config_.control_dt);
  for (int i = 0; i < settling && status == StepStatus::kOk; ++i)
    status = backend_->step(e.legs.update(feet, config_.control_dt), substeps_);
  if (status == StepStatus::kOk)
    status = control(e.draw[Randomised::kStartPhase] * config_.parameters.cycle_time);

  const RobotState& state = backend_->state();
  e.start = state.p_WB;
  e.start_yaw = roll_pitch_yaw(state.q_WB).z();
  e.standing_height = state.p_WB.z() - backend_->spec().terrain.height(state.p_WB.x(), state.p_WB.y());
  e.weight = backend_->robot().total_mass() * backend_->spec().gravity.norm();
  e.next_push = e.draw[Randomised::kPushInterval];
  e.info.diverged = status != StepStatus::kOk;
  e.result.terminated = e.info.diverged;
  measure();
  observe(observation);
}

StepStatus AdaptiveGaitEnv::control(double seconds) noexcept {
  Episode& e = episode_;
  const int updates = step_count(seconds, config_.control_dt);
  for (int i = 0; i < updates; ++i) {
    const LegArray<FootTarget>& feet = e.controller.update(config_.control_dt);
    e.targets = e.legs.update(target_positions(feet), config_.control_dt);
    if (const StepStatus status = backend_->step(e.targets, substeps_); status != StepStatus::kOk)
      return status;
  }
  return StepStatus::kOk;
}

void AdaptiveGaitEnv::push_if_due() noexcept {
  Episode& e = episode_;
  if (!config_.randomisation.is_on(Randomised::kPushImpulse) || e.info.time < e.next_push) return;
  const auto between = [&](Randomised what) {
    const Range& range = config_.randomisation[what];
    return e.random.uniform(range.min, range.max);
  };
  const double impulse = between(Randomised::kPushImpulse), angle = e.random.uniform(-M_PI, M_PI);
  backend_->apply_push({impulse * std::cos(angle), impulse * std::sin(angle), 0});
  e.next_push += between(Randomised::kPushInterval);
}

void AdaptiveGaitEnv::take_action(std::span<const double> action) noexcept {
  Episode& e = episode_;
  std::swap(e.action, e.last_action);
  std::swap(e.parameters, e.last_parameters);
  e.info.invalid_actions = 0;
  for (std::size_t i = 0; i < action.size(); ++i) {
    const bool finite = std::isfinite(action[i]);
    e.info.invalid_actions += finite ? 0 : 1;
    e.action[i] = finite ? std::clamp(action[i], -1.0, 1.0) : 0;
  }
  e.controller.apply_action(e.action);
}

StepResult AdaptiveGaitEnv::step(std::span<const double> action, std::span<double> observation) {
  check_size(kSource, "action", action.size(), action_size());
  check_size(kSource, "observation", observation.size(), observation_size());
  Episode& e = episode_;
  if (e.result.done()) {
    e.result.reward = 0;
  } else {
    const RobotState before = backend_->state();
    const auto clamped = e.legs.clamped();
    push_if_due();
    take_action(action);
    const StepStatus status = control(config_.policy_dt);
    e.info.ik_clamped = static_cast<int>(e.legs.clamped() - clamped);
    finish_step(before, status);
  }
  observe(observation);
  return e.result;
}

void AdaptiveGaitEnv::finish_step(const RobotState& before, StepStatus status) noexcept {
  Episode& e = episode_;
  ++e.steps;
  e.info.time = e.steps * config_.policy_dt;
  e.info.limit_factor = e.controller.generator().limit_factor();
  measure();
  const Vector3& p = backend_->state().p_WB;
  const double tilt = e.info.roll_pitch_yaw.head<2>().cwiseAbs().maxCoeff() * kDegrees;
  e.info.fell = tilt > config_.tilt_limit_deg;
  e.info.left_terrain = !backend_->spec().terrain.contains(p.x(), p.y());
  e.info.diverged = status != StepStatus::kOk;
  e.result.terminated = e.info.fell || e.info.left_terrain || e.info.diverged;
  e.result.truncated = !e.result.terminated && e.steps >= max_steps_;
  e.result.reward = evaluate(before);
}

void AdaptiveGaitEnv::measure() noexcept {
  Episode& e = episode_;
  const RobotState& state = backend_->state();
  foot_kinematics_.update(state, feet_);
  e.info.contacts = backend_->foot_contacts();
  for (const Leg leg : kLegs) e.info.swing[leg] = e.controller.is_swing(leg);
  e.info.parameters = e.controller.parameters();
  for (std::size_t i = 0; i < e.parameters.size(); ++i)
    e.parameters[i] = e.info.parameters.*e.controller.adapted()[i]->member;
  if (e.steps == 0) e.last_parameters = e.parameters;
  e.info.roll_pitch_yaw = roll_pitch_yaw(state.q_WB);
  e.info.roll_pitch_yaw.z() = std::remainder(e.info.roll_pitch_yaw.z() - e.start_yaw, 2 * M_PI);
  const Vector3 moved = in_heading(state.p_WB - e.start, e.start_yaw);
  e.info.distance = moved.x();
  e.info.lateral = moved.y();
  e.info.power = 0;
  for (const int i : servos_) e.info.power += std::abs(backend_->torques()[i] * state.qd[i]);
}

double AdaptiveGaitEnv::evaluate(const RobotState& before) noexcept {
  Episode& e = episode_;
  const RobotState& after = backend_->state();
  const WorldSpec& world = backend_->spec();
  const StepRecord record{
      .dt = config_.policy_dt,
      .robot = *world.robot,
      .before = before,
      .after = after,
      .torques = backend_->torques(),
      .v_start = in_heading(after.v_WB, e.start_yaw),
      .v_heading = in_heading(after.v_WB, e.start_yaw + e.info.roll_pitch_yaw.z()),
      .roll_pitch_yaw = e.info.roll_pitch_yaw,
      .height = after.p_WB.z() - world.terrain.height(after.p_WB.x(), after.p_WB.y()),
      .standing_height = e.standing_height,
      .command = e.command,
      .contacts = e.info.contacts,
      .swing = e.info.swing,
      .action = e.action,
      .last_action = e.last_action,
      .parameters = e.parameters,
      .last_parameters = e.last_parameters,
      .servos = servos_,
      .weight = e.weight,
      .fell = e.info.fell || e.info.left_terrain,
  };
  return evaluate_reward(record, config_.reward, e.info.reward_terms);
}

void AdaptiveGaitEnv::observe(std::span<double> observation) const noexcept {
  const Episode& e = episode_;
  const ObservationSource source{*backend_, feet_,   e.info.contacts, e.controller,
                                 e.command, servos_, e.action};
  double* out = observation.data();
  for (const ObservationBlock* block : blocks_) block->write(source, out);
}

void AdaptiveGaitEnv::set_command(const VelocityCommand& command) {
  if (!episode_.controller.generator().set_command(command)) {
    throw ConfigError(kSource, "command", "finite vx, vy (m/s) and yaw rate (rad/s)",
                      fmt::format("{}, {}, {}", command.vx, command.vy, command.yaw_rate));
  }
  episode_.command = command;
}

std::shared_ptr<const AdaptiveGaitEnv::Saved> AdaptiveGaitEnv::save() const {
  return std::make_shared<const Saved>(Saved{episode_, backend_->spec(), backend_->save(),
                                             layout_hash(interface_.observation, interface_.action)});
}

void AdaptiveGaitEnv::restore(const Saved& saved) {
  const std::string own = layout_hash(interface_.observation, interface_.action);
  if (saved.layout != own)
    throw ConfigError("restore", "layout", fmt::format("an environment of layout {}", own), saved.layout);
  // A world that was drawn for its episode goes with it.
  const WorldSpec& world = backend_->spec();
  if (config_.randomisation.changes_world() &&
      (world.robot != saved.world.robot || world.terrain.field() != saved.world.terrain.field())) {
    backend_ = engine_.make(saved.world);
  }
  backend_->restore(saved.physics);
  episode_ = saved.episode;
  foot_kinematics_.update(backend_->state(), feet_);
}

}  // namespace crossgait
