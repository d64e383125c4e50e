#include "crossgait/env/adaptive_gait_env.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "crossgait/env/check_size.h"
#include "crossgait/env/gait_source.h"
#include "crossgait/physics/error.h"

namespace crossgait {
namespace {

constexpr std::string_view kSource = "environment";

// Components of a horizontal vector in a frame turned by `yaw`; z as it is.
Vector3 in_heading(const Vector3& v, double yaw) noexcept {
  const double c = std::cos(yaw), s = std::sin(yaw);
  return {c * v.x() + s * v.y(), c * v.y() - s * v.x(), v.z()};
}

}  // namespace

AdaptiveGaitEnv::AdaptiveGaitEnv(std::shared_ptr<const EnvModel> model, Engine engine)
    : model_(std::move(model)), engine_(std::move(engine)), episode_(make_episode()), source_(make_source()) {
  if (!config().randomisation.changes_world()) backend_ = engine_.make(model_->world);
}

AdaptiveGaitEnv::AdaptiveGaitEnv(const EnvConfig& config, Engine engine)
    : AdaptiveGaitEnv(EnvModel::make(config), std::move(engine)) {}

AdaptiveGaitEnv::Episode AdaptiveGaitEnv::make_episode() const {
  const EnvConfig& c = config();
  OutcomeLimits limits;
  limits.tilt_deg = c.tilt_limit_deg;
  Episode episode{.controller = model_->make_controller(),
                  .legs = LegController(model_->world.robot),
                  .loop = ClosedLoop(*model_->world.robot, {c.control_dt, c.settle_seconds, limits, c.ends})};
  episode.parameters.assign(episode.controller.adapted().size(), 0);
  episode.last_parameters = episode.parameters;
  episode.action.assign(action_size(), 0);
  episode.last_action = episode.action;
  return episode;
}

TargetSource AdaptiveGaitEnv::make_source() {
  const auto stay = [this](double dt, ControlTargets& out) {
    solve_legs(episode_.legs, episode_.standing, dt, out);
    episode_.info.ik_clamped += out.ik_clamped;
  };
  const auto advance = [this](double dt, ControlTargets& out) {
    const LegArray<FootTarget>& feet = episode_.controller.update(dt);
    drive_legs(episode_.legs, episode_.controller.generator(), feet,
               config().command ? std::optional(episode_.command) : std::nullopt, dt, out);
    episode_.info.ik_clamped += out.ik_clamped;
  };
  const auto look = [this](const RobotState& state, double dt) {
    const double turning = episode_.command.yaw_rate;  // also of a command that came later
    episode_.controller.generator().set_steering(
        episode_.heading.look(model_->heading_hold, state, turning, dt));
  };
  return {.stand =
              [this](const Terrain& terrain, const Placement& placement) {
                return episode_.legs.standing_state(episode_.standing, terrain, placement);
              },
          .hold = stay,
          .advance = advance,
          .look = look};
}

WorldSpec AdaptiveGaitEnv::draw_world() {
  const EnvConfig& c = config();
  WorldSpec world = randomised_world(model_->world, c.randomisation, episode_.draw, episode_.random);
  if (c.randomisation.is_on(Randomised::kTerrainSeed)) {
    const auto seed = static_cast<std::uint64_t>(episode_.draw[Randomised::kTerrainSeed]);
    world.terrain = make_terrain(c.terrain, seed);
  }
  return world;
}

Start AdaptiveGaitEnv::draw_start() const {
  const RandomDraw& draw = episode_.draw;
  return {placement_of(draw), draw[Randomised::kStartPhase] * model_->parameters.cycle_time,
          Pushes(config().randomisation, draw, episode_.random)};
}

void AdaptiveGaitEnv::reset(std::uint64_t seed, std::span<double> observation) {
  check_size(kSource, "observation", observation.size(), observation_size());
  Episode& e = episode_;
  e.begun = false;  // until all of it has worked
  e.random = Random(seed);
  e.draw = draw(config().randomisation, e.random);
  if (config().randomisation.changes_world()) backend_ = engine_.make(draw_world());

  if (config().command) {
    static_cast<void>(e.controller.generator().set_command(*config().command));  // finite: validated
  } else {
    e.controller.generator().clear_command();
  }
  e.command = config().command.value_or(VelocityCommand{});
  e.controller.generator().set_steering(0);
  e.controller.reset(GaitGenerator::Start::kStanding);
  e.legs.restart();
  e.heading.restart();
  e.steps = 0;
  e.result = {};
  e.info = {};
  std::fill(e.action.begin(), e.action.end(), 0.0);

  // Standing is the gait's first target held; walking begins after it, part of a cycle if so drawn.
  e.standing = target_positions(e.controller.targets());
  e.controller.generator().set_sweep(e.legs.foot_sweep(e.standing, e.controller.parameters()));
  e.legs.set_load_share(e.controller.parameters().load_share);
  e.loop.start(*backend_, source_, draw_start());
  e.result.terminated = e.loop.ended();
  e.begun = true;
  measure();
  observe(observation);
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
  require_begun("step");
  Episode& e = episode_;
  if (e.result.done()) {
    e.result.reward = 0;
  } else {
    const RobotState before = backend_->state();
    take_action(action);
    e.info.ik_clamped = 0;
    e.loop.advance(*backend_, source_, model_->policy_steps);
    finish_step(before);
  }
  observe(observation);
  return e.result;
}

void AdaptiveGaitEnv::finish_step(const RobotState& before) {
  Episode& e = episode_;
  ++e.steps;
  e.info.time = e.steps * config().policy_dt;
  e.info.limit_factor = e.controller.generator().limit_factor();
  measure();
  e.result.terminated = e.loop.ended();
  e.result.truncated = !e.result.terminated && e.steps >= model_->max_steps;
  e.result.reward = evaluate(before);
}

void AdaptiveGaitEnv::measure() {
  Episode& e = episode_;
  const RobotState& state = backend_->state();
  const MotionStatistics& statistics = e.loop.statistics();
  model_->foot_kinematics.update(state, feet_);
  e.info.contacts = backend_->foot_contacts();
  for (const Leg leg : kLegs) e.info.swing[leg] = e.controller.is_swing(leg);
  e.info.parameters = e.controller.parameters();
  for (std::size_t i = 0; i < e.parameters.size(); ++i)
    e.parameters[i] = e.info.parameters.*e.controller.adapted()[i].member;
  if (e.steps == 0) e.last_parameters = e.parameters;
  e.info.roll_pitch_yaw = roll_pitch_yaw(state.q_WB);
  e.info.roll_pitch_yaw.z() = std::remainder(e.info.roll_pitch_yaw.z() - statistics.start_yaw(), 2 * M_PI);
  const Vector3 moved = in_heading(state.p_WB - statistics.start(), statistics.start_yaw());
  e.info.distance = moved.x();
  e.info.lateral = moved.y();
  e.info.power = servo_power(*backend_, model_->servos);
  e.info.outcome = statistics.worst();
}

double AdaptiveGaitEnv::evaluate(const RobotState& before) {
  Episode& e = episode_;
  const RobotState& after = backend_->state();
  const MotionStatistics& statistics = e.loop.statistics();
  const WorldSpec& world = backend_->spec();
  const StepRecord record{
      .dt = config().policy_dt,
      .before = before,
      .after = after,
      .torques = backend_->torques(),
      .v_start = in_heading(after.v_WB, statistics.start_yaw()),
      .v_heading = in_heading(after.v_WB, statistics.start_yaw() + e.info.roll_pitch_yaw.z()),
      .roll_pitch_yaw = e.info.roll_pitch_yaw,
      .height = after.p_WB.z() - world.terrain.height(after.p_WB.x(), after.p_WB.y()),
      .standing_height = statistics.begin_height(),
      .command = e.command,
      .contacts = e.info.contacts,
      .swing = e.info.swing,
      .action = e.action,
      .last_action = e.last_action,
      .parameters = e.parameters,
      .last_parameters = e.last_parameters,
      .servos = model_->servos,
      .weight = statistics.weight(),
      .power = e.info.power,
      .failed = e.result.terminated,
  };
  return evaluate_reward(record, config().reward, e.info.reward_terms);
}

void AdaptiveGaitEnv::observe(std::span<double> observation) const {
  const Episode& e = episode_;
  const ObservationSource source{*backend_, feet_,          e.info.contacts, e.controller,
                                 e.command, model_->servos, e.action};
  double* out = observation.data();
  for (const ObservationBlock* block : model_->blocks) block->write(source, out);
}

void AdaptiveGaitEnv::set_command(const VelocityCommand& command) {
  if (!episode_.controller.generator().set_command(command)) {
    throw ConfigError(kSource, "command", "finite vx, vy (m/s) and yaw rate (rad/s)",
                      fmt::format("{}, {}, {}", command.vx, command.vy, command.yaw_rate));
  }
  episode_.command = command;
}

void AdaptiveGaitEnv::require_begun(std::string_view what) const {
  if (!episode_.begun) throw ConfigError(kSource, what, "a reset before it", "none");
}

std::shared_ptr<const AdaptiveGaitEnv::Saved> AdaptiveGaitEnv::save() const {
  require_begun("save");
  return std::make_shared<const Saved>(Saved{episode_, backend_->spec(), backend_->save(), model_->layout});
}

void AdaptiveGaitEnv::restore(const Saved& saved) {
  if (saved.layout != model_->layout) {
    throw ConfigError("restore", "layout", fmt::format("an environment of layout {}", model_->layout),
                      saved.layout);
  }
  // A world that was drawn for its episode goes with it.
  const bool foreign = backend_ == nullptr || backend_->spec().robot != saved.world.robot ||
                       backend_->spec().terrain.field() != saved.world.terrain.field();
  if (config().randomisation.changes_world() && foreign) backend_ = engine_.make(saved.world);
  backend_->restore(saved.physics);
  episode_ = saved.episode;
  model_->foot_kinematics.update(backend_->state(), feet_);
}

}  // namespace crossgait
