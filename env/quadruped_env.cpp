#include "env/quadruped_env.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "motion/gait_source.h"
#include "physics/core/check_size.h"
#include "physics/core/error.h"
#include "physics/core/heading.h"

namespace crossgait {
namespace {

constexpr std::string_view kSource = "environment";

std::variant<GaitControl, JointControl> make_control(const EnvModel& model) {
  if (model.config.action == ActionKind::kGait) return GaitControl(model);
  return JointControl(model);
}

constexpr std::uint64_t kNoiseStream = 0x6e6f697365;  // "noise": random numbers of the observer

// But for the engine, which the world knows.
bool are_alike(EnvConfig a, EnvConfig b) {
  a.engine = b.engine = {};
  return to_yaml(a) == to_yaml(b) && (a.extension == nullptr) == (b.extension == nullptr);
}

}  // namespace

QuadrupedEnv::QuadrupedEnv(std::shared_ptr<const EnvModel> model, Engine engine,
                           std::shared_ptr<WorldGroup> group)
    : model_(std::move(model)),
      engine_(std::move(engine)),
      group_(std::move(group)),
      base_world_(model_->world),
      episode_(make_episode()) {
  if (!config().randomisation.changes_world()) world_ = make_world(model_->world);
  if (config().extension != nullptr) extension_ = config().extension->make();
}

QuadrupedEnv::QuadrupedEnv(const LoadedEnv& loaded, Engine engine)
    : QuadrupedEnv(EnvModel::make(loaded), std::move(engine)) {}

std::unique_ptr<PhysicsBackend> QuadrupedEnv::make_world(WorldSpec spec) const {
  spec.group = group_;
  return engine_.make(spec);
}

QuadrupedEnv::Episode QuadrupedEnv::make_episode() const {
  const EnvConfig& c = config();
  OutcomeLimits limits;
  limits.tilt_deg = c.tilt_limit_deg;
  Episode episode{
      .control = make_control(*model_),
      .loop = ClosedLoop(*model_->world.robot, {c.control_dt, c.settle_seconds, limits, c.terminations}),
      .observer = model_->observer};
  if (const auto* control = std::get_if<GaitControl>(&episode.control))
    episode.parameters.assign(control->controller().adapted().size(), 0);
  episode.last_parameters = episode.parameters;
  episode.action.assign(action_size(), 0);
  episode.last_action = episode.action;
  episode.last_observation.assign(observation_size(), 0);
  return episode;
}

const AdaptiveGaitController* QuadrupedEnv::gait() const noexcept {
  const auto* control = std::get_if<GaitControl>(&episode_.control);
  return control == nullptr ? nullptr : &control->controller();
}

Controller& QuadrupedEnv::control() noexcept {
  if (auto* gait = std::get_if<GaitControl>(&episode_.control)) return *gait;
  return *std::get_if<JointControl>(&episode_.control);
}

RobotState QuadrupedEnv::Watched::initial_state(const Terrain& terrain, const Placement& placement) const {
  return env_.control().initial_state(terrain, placement);
}

void QuadrupedEnv::Watched::hold_pose(double dt, ControlTargets& out) {
  env_.control().hold_pose(dt, out);
  env_.episode_.info.ik_clamped += out.ik_clamped;
}

void QuadrupedEnv::Watched::advance(double dt, ControlTargets& out) {
  env_.control().advance(dt, out);
  env_.episode_.info.ik_clamped += out.ik_clamped;
}

void QuadrupedEnv::Watched::observe(const RobotState& state, double dt) {
  env_.control().observe(state, dt);
  env_.observe_substep();
}

WorldSpec QuadrupedEnv::draw_world() {
  const EnvConfig& c = config();
  WorldSpec world = randomised_world(model_->world, c.randomisation, episode_.draw, episode_.random);
  if (c.randomisation.is_on(Randomised::kTerrainSeed)) {
    const auto seed = static_cast<std::uint64_t>(episode_.draw[Randomised::kTerrainSeed]);
    world.terrain = model_->ground.make(seed);
  }
  return world;
}

Start QuadrupedEnv::draw_start() const {
  const RandomDraw& draw = episode_.draw;
  Start start{placement_of(draw), draw[Randomised::kStartPhase] * model_->parameters.cycle_time,
              pushes_of(config().randomisation, draw, episode_.random)};
  if (config().start != StartSettings() || randomises_start(config().randomisation)) {
    const Terrain& terrain = world_->spec().terrain;
    const RobotState standing = watched_.initial_state(terrain, start.placement);
    start.state = start_state(config().start, config().randomisation, draw, *model_->world.robot, terrain,
                              start.placement, standing);
  }
  return start;
}

void QuadrupedEnv::reset(std::uint64_t seed, std::span<double> observation) {
  check_size(kSource, "observation", observation.size(), observation_size());
  Episode& e = episode_;
  if (extension_ != nullptr && e.begun) extension_->end(*this);
  e.begun = false;  // until all of it has worked
  e.random = Random(seed);
  e.draw = draw(config().randomisation, e.random);
  if (config().randomisation.changes_world()) {
    base_world_ = draw_world();
    world_ = make_world(changed(base_world_, changes_));
  }

  std::visit([this](auto& control) { control.restart(config().command); }, e.control);
  e.command = config().command.value_or(VelocityCommand{});
  e.seed = seed;
  e.observer.restart(derived_seed(seed, kNoiseStream));
  e.steps = e.control_steps = 0;
  e.result = {};
  e.info = {};
  std::fill(e.action.begin(), e.action.end(), 0.0);

  // Standing first; motion begins after it, part of a gait's cycle if so drawn.
  e.loop.start(*world_, watched_, draw_start());
  e.result.terminated = e.loop.ended();
  e.begun = true;
  e.joint_acceleration = JointVector::Zero(world_->state().qd.size());
  measure();
  e.foot_times.begin(e.info.contacts);
  if (extension_ != nullptr && !e.result.terminated) {
    try {
      extension_->begin(*this, seed);  // whose events change an episode that has begun
    } catch (...) {
      e.begun = false;
      throw;
    }
  }
  observe(observation);
}

void QuadrupedEnv::take_action(std::span<const double> action) noexcept {
  Episode& e = episode_;
  std::swap(e.action, e.last_action);
  std::swap(e.parameters, e.last_parameters);
  e.info.invalid_actions = e.info.clipped_actions = 0;
  for (std::size_t i = 0; i < action.size(); ++i) {
    const bool finite = std::isfinite(action[i]);
    e.info.invalid_actions += finite ? 0 : 1;
    const auto& [least, most] = model_->action_bounds[i];
    e.action[i] = finite ? std::clamp(action[i], least, most) : 0;
    e.info.clipped_actions += finite && e.action[i] != action[i] ? 1 : 0;
  }
  if (auto* joints = std::get_if<JointControl>(&e.control)) {
    joints->apply(e.action, world_->state());
  } else {
    std::get_if<GaitControl>(&e.control)->apply(e.action);
  }
}

StepResult QuadrupedEnv::step(std::span<const double> action, std::span<double> observation) {
  check_size(kSource, "action", action.size(), action_size());
  check_size(kSource, "observation", observation.size(), observation_size());
  require_begun("step");
  Episode& e = episode_;
  if (e.result.done()) {
    e.result.reward = 0;
    std::copy(e.last_observation.begin(), e.last_observation.end(), observation.begin());
    return e.result;
  }
  const RobotState before = world_->state();
  const MotionIntegrals integrals_before = e.loop.statistics().integrals();
  take_action(action);
  e.info.ik_clamped = e.control_steps = 0;
  e.loop.advance(*world_, watched_, model_->policy_steps);
  world_->clear_wrenches();
  finish_step(before, integrals_before);
  if (extension_ != nullptr && !e.result.done()) extension_->change(*this);
  observe(observation);
  return e.result;
}

void QuadrupedEnv::finish_step(const RobotState& before, const MotionIntegrals& integrals_before) {
  Episode& e = episode_;
  ++e.steps;
  e.info.time = e.steps * config().policy_dt;
  e.info.limit_factor = e.loop.targets().limit_factor;
  measure();
  e.foot_times.add(e.info.contacts, config().policy_dt);
  e.joint_acceleration = (world_->state().qd - before.qd) / config().policy_dt;
  const MotionIntegrals during = e.loop.statistics().integrals() - integrals_before;
  e.info.power = during.seconds > 0 ? during.work / during.seconds : 0;
  e.result.terminated = e.loop.ended();
  e.result.truncated = !e.result.terminated && e.steps >= model_->max_steps;
  EnvExtension::Step own;
  if (extension_ != nullptr) own = extension_->step(*this);
  if (own.terminated && !e.result.terminated) terminate();
  e.result.truncated = !e.result.terminated && (e.result.truncated || own.truncated);
  e.result.reward = evaluate(before, during) + own.reward;
}

void QuadrupedEnv::terminate() {
  episode_.loop.terminated();
  episode_.info.outcome = episode_.loop.statistics().worst();
  episode_.result.terminated = true;
}

void QuadrupedEnv::measure() {
  Episode& e = episode_;
  const RobotState& state = world_->state();
  const MotionStatistics& statistics = e.loop.statistics();
  model_->foot_kinematics.update(state, feet_);
  e.info.contacts = world_->foot_contacts();
  if (const AdaptiveGaitController* controller = gait()) {
    for (const Leg leg : kLegs) e.info.swing[leg] = controller->is_swing(leg);
    e.info.parameters = controller->parameters();
    for (std::size_t i = 0; i < e.parameters.size(); ++i)
      e.parameters[i] = controller->parameters().*controller->adapted()[i].member;
  }
  if (e.steps == 0) e.last_parameters = e.parameters;
  e.info.roll_pitch_yaw = statistics.roll_pitch_yaw();
  const Vector3 moved = statistics.start_heading().components(state.p_WB - statistics.start());
  e.info.distance = moved.x();
  e.info.lateral = moved.y();
  e.info.outcome = statistics.worst();
}

double QuadrupedEnv::evaluate(const RobotState& before, const MotionIntegrals& during) {
  Episode& e = episode_;
  const RobotState& after = world_->state();
  const MotionStatistics& statistics = e.loop.statistics();
  const WorldSpec& world = world_->spec();
  const StepRecord record{
      .dt = config().policy_dt,
      .before = before,
      .after = after,
      .v_start = statistics.start_heading().components(after.v_WB),
      .v_heading = Heading(after.q_WB).components(after.v_WB),
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
      .servos = model_->joints.servos,
      .weight = statistics.weight(),
      .during = during,
      .size = model_->size,
      .terminated = e.result.terminated,
  };
  return evaluate_reward(record, config().reward, e.info.reward_terms);
}

ObservationSource QuadrupedEnv::seen() const noexcept {
  const Episode& e = episode_;
  return {*world_,
          feet_,
          e.info.contacts,
          gait(),
          e.command,
          model_->joints.observed,
          model_->joints.observed_home,
          e.action,
          e.loop.targets().joints,
          model_->joints.observed_slots,
          config().observing,
          e.info.time};
}

void QuadrupedEnv::observe(std::span<double> observation) {
  Episode& e = episode_;
  const std::size_t own = e.observer.layout().size();
  e.observer.observe(seen(), observation.first(own));
  if (extension_ != nullptr) extension_->observe(*this, observation.subspan(own));
  std::copy(observation.begin(), observation.end(), e.last_observation.begin());
}

// The observer sees the instants between the control steps of a policy step; those at its ends in `observe`.
void QuadrupedEnv::observe_substep() {
  Episode& e = episode_;
  if (!e.begun || !e.observer.samples_substeps() || e.control_steps++ == 0) return;
  model_->foot_kinematics.update(world_->state(), feet_);
  e.info.contacts = world_->foot_contacts();
  e.observer.sample(seen());
}

void QuadrupedEnv::set_command(const VelocityCommand& command) {
  if (!command.is_finite()) {
    throw ConfigError(kSource, "command", "finite vx, vy (m/s) and yaw rate (rad/s)",
                      fmt::format("{}, {}, {}", command.vx, command.vy, command.yaw_rate));
  }
  std::visit([&command](auto& control) { control.set_command(command); }, episode_.control);
  episode_.command = command;
}

void QuadrupedEnv::set_state(RobotState state) {
  require_going("set_state");
  state.time = world_->state().time;
  world_->reset(state);
  episode_.loop.moved(*world_);
  measure();
}

void QuadrupedEnv::apply_wrench(const BodyWrench& wrench) {
  require_going("apply_wrench");
  world_->apply_wrench(wrench);
}

void QuadrupedEnv::set_changes(std::vector<QuantityChange> changes) {
  require_begun("parameters");
  require_under_way(changes, kSource);
  auto world = make_world(changed(base_world_, changes));
  world->restore(world_->save());
  world_ = std::move(world);
  changes_ = std::move(changes);
}

void QuadrupedEnv::forget() {
  if (extension_ == nullptr) return;
  if (!std::exchange(changes_, {}).empty() && !config().randomisation.changes_world())
    world_ = make_world(base_world_);
  extension_ = config().extension->make();
}

void QuadrupedEnv::end_episode(bool terminated) {
  require_going("end_episode");
  if (terminated) terminate();
  episode_.result.terminated = terminated;
  episode_.result.truncated = !terminated;
}

double QuadrupedEnv::end_in_step(bool terminated) {
  end_episode(terminated);
  static const std::size_t kTermination = find_reward_term("termination");
  RewardTerms& terms = episode_.info.reward_terms;
  if (terminated) terms[kTermination] = config().reward[kTermination];
  episode_.result.reward = 0;  // in the table's order, so that it is the same to the bit
  for (std::size_t i = 0; i < RewardTerms::size(); ++i) episode_.result.reward += terms[i];
  return episode_.result.reward;
}

void QuadrupedEnv::observe_start(std::span<double> observation) {
  check_size(kSource, "observation", observation.size(), observation_size());
  require_begun("observe_start");
  Episode& e = episode_;
  if (e.steps > 0)
    throw ConfigError(kSource, "observe_start", "an episode without steps", fmt::format("{}", e.steps));
  e.observer.restart(derived_seed(e.seed, kNoiseStream));
  observe(observation);
}

void QuadrupedEnv::require_begun(std::string_view what) const {
  if (!episode_.begun) throw ConfigError(kSource, what, "a reset before it", "none");
}

void QuadrupedEnv::require_going(std::string_view what) const {
  require_begun(what);
  if (episode_.result.done())
    throw ConfigError(kSource, what, "an episode that goes on", "one that has ended");
}

std::shared_ptr<const QuadrupedEnv::Saved> QuadrupedEnv::save() const {
  require_begun("save");
  return std::make_shared<const Saved>(Saved{episode_, world_->spec(), base_world_, changes_, world_->save(),
                                             extension_ != nullptr ? extension_->save() : nullptr, model_});
}

void QuadrupedEnv::restore(const Saved& saved) {
  if (saved.model != model_ && !are_alike(saved.model->config, config()))
    throw ConfigError("restore", "configuration", "an episode of this environment's", "of another");
  // A world that was drawn for its episode, or changed, goes with it.
  const bool foreign = world_ == nullptr || world_->spec().robot != saved.world.robot ||
                       world_->spec().terrain.field() != saved.world.terrain.field();
  const bool differs = config().randomisation.changes_world() || !changes_.empty() || !saved.changes.empty();
  if (differs && foreign) {
    world_ = make_world(saved.world);
    base_world_ = saved.base_world;
    changes_ = saved.changes;
  }
  world_->restore(saved.physics);
  episode_ = saved.episode;
  if (extension_ != nullptr) extension_->restore(saved.extension);
  model_->foot_kinematics.update(world_->state(), feet_);
}

}  // namespace crossgait
