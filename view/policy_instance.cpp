#include "view/policy_instance.h"

#include "physics/core/error.h"
#include "view/gait_drive.h"

namespace crossgait {
namespace {

/// A day, s.
constexpr double kLongestView = 86'400;

std::shared_ptr<const EnvModel> model_of(LoadedEnv environment) {
  EnvConfig& config = environment.config;
  config.randomisation = {};
  config.command = VelocityCommand{};
  config.episode_seconds = kLongestView;
  config.terminations = OutcomeSet::of_walks();
  return EnvModel::make(environment);
}

[[noreturn]] void refuse_to_meddle(const std::string& what) {
  throw ConfigError("drive", what, "speed and turn: the rest is the policy's", what);
}

}  // namespace

PolicyInstance::PolicyInstance(const Engine& engine, const LoadedEnv& environment, const std::string& policy)
    : PolicyInstance(engine, environment, load_policy(policy)) {}

PolicyInstance::PolicyInstance(const Engine& engine, const LoadedEnv& environment, PolicyFactory make)
    : make_(std::move(make)),
      env_(model_of(environment), engine),
      policy_(make_(env_.interface())),
      observation_(env_.observation_size()),
      action_(env_.action_size()) {
  stand_up();
}

PolicyInstance::PolicyInstance(const Engine& engine, const PolicyInstance& other)
    : make_(other.make_),
      env_(std::make_shared<const EnvModel>(other.env_.model()), engine),
      policy_(make_(env_.interface())),
      command_(other.command_),
      observation_(other.observation_),
      action_(other.action_),
      steps_left_(other.steps_left_) {
  policy_->reset(0);
  QuadrupedEnv::Saved saved = *other.env_.save();
  const auto world = engine.make(saved.world);
  world->reset(saved.physics.state);
  saved.physics = world->save();
  env_.restore(saved);
  const std::span<const QuantityChange> changes = other.env_.changes();
  if (!changes.empty()) env_.set_changes({changes.begin(), changes.end()});
}

std::unique_ptr<RobotInstance> PolicyInstance::with_engine(const Engine& engine) const {
  return std::unique_ptr<RobotInstance>(new PolicyInstance(engine, *this));
}

std::unique_ptr<RobotInstance> PolicyInstance::with_terrain(const Engine& engine,
                                                            const TerrainChoice& ground) const {
  EnvConfig config = env_.config();
  config.terrain = ground.terrain;
  config.terrain_seed = ground.seed;
  return std::unique_ptr<RobotInstance>(
      new PolicyInstance(engine, env_.model().loaded().with(config), make_));
}

std::unique_ptr<RobotInstance> PolicyInstance::with_changes(
    const Engine& engine, const std::vector<QuantityChange>& changes) const {
  std::unique_ptr<PolicyInstance> changed(new PolicyInstance(engine, *this));
  changed->env_.set_changes(changes);
  return changed;
}

struct PolicyInstance::Moment : Saved {
  std::shared_ptr<const QuadrupedEnv::Saved> env;
  VelocityCommand command;
  std::vector<double> observation, action;
  int steps_left = 0;
};

std::unique_ptr<RobotInstance::Saved> PolicyInstance::save() const {
  auto moment = std::make_unique<Moment>();
  moment->env = env_.save();
  moment->command = command_;
  moment->observation = observation_;
  moment->action = action_;
  moment->steps_left = steps_left_;
  return moment;
}

void PolicyInstance::restore(const Saved& saved) {
  const auto& moment = dynamic_cast<const Moment&>(saved);
  env_.restore(*moment.env);
  policy_->reset(0);
  command_ = moment.command;
  observation_ = moment.observation;
  action_ = moment.action;
  steps_left_ = moment.steps_left;
}

void PolicyInstance::pull(const Vector3& force) {
  if (steps_left_ == 0) env_.apply_wrench({.wrench = {force}});
}

void PolicyInstance::step() {
  if (steps_left_ == 0) {
    policy_->act(observation_, action_);
    env_.step(action_, observation_);
    steps_left_ = env_.model().policy_steps;
  }
  --steps_left_;
}

void PolicyInstance::stand_up() {
  policy_->reset(0);
  env_.reset(0, observation_);
  command_ = {};
  steps_left_ = 0;
}

void PolicyInstance::push(const Vector3& impulse) {
  if (!impulse.allFinite()) throw ConfigError("drive", "push", "three finite numbers, N s", "not finite");
  QuadrupedEnv::Saved saved = *env_.save();
  saved.physics.push += impulse;
  env_.restore(saved);
}

void PolicyInstance::set_command(const VelocityCommand& command) {
  check_drive(env_.world().robot(), command);
  env_.set_command(command);
  command_ = command;
}

void PolicyInstance::set_gait(const std::string& gait) { refuse_to_meddle(gait); }
void PolicyInstance::set_parameter(const std::string& name, double /*value*/) { refuse_to_meddle(name); }

void PolicyInstance::set_curve(const std::string& curve) { refuse_to_meddle(curve); }

std::string PolicyInstance::chosen_gait() const {
  return gait() == nullptr ? std::string() : std::string(gait()->gait().name);
}

const GaitGenerator* PolicyInstance::gait() const noexcept {
  const AdaptiveGaitController* controller = env_.gait();
  return controller == nullptr ? nullptr : &controller->generator();
}

}  // namespace crossgait
