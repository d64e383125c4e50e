#include "backends/physx/physx_backend.h"

#include <limits>
#include <stdexcept>
#include <tuple>

#include "backends/physx/articulation_model.h"
#include "backends/physx/coupled_joints.h"
#include "backends/physx/matched_backend.h"
#include "backends/physx/settings.h"
#include "backends/physx/step_contacts.h"
#include "backends/physx/version.h"
#include "physics/core/error.h"
#include "physics/engine/lost_engine.h"

namespace crossgait::physx {
namespace {

// Squares of what goes into a step have to be float32 numbers.
constexpr double kMost = 1e15;  // N, N m

EngineInfo make_info(const Settings& settings) {
  EngineInfo info;
  info.name = settings.name;
  info.library = "PhysX";
  info.version = version();
  info.mode = settings.temporal ? "hard contact, patch friction, temporal Gauss-Seidel"
                                : "hard contact, patch friction, projected Gauss-Seidel";
  const std::string way =
      (settings.temporal ? "/temporal" : "/sweeps") + std::string(split_factors(settings.name).second);
  // By sweeps friction is bounded along two directions, each by itself.
  info.laws = {.contact = (settings.temporal ? "patch" : "patch+pyramid") + way,
               .loops = (settings.loops ? "hard" : "mujoco") + way,
               .joint_friction = "hard" + way,
               .joint_limits = "hard" + way,
               .couplings = "hard" + way,
               .implicit_servos = "implicit" + way,
               .contact_family = "rigid"};
  info.capabilities.exact_field_query = true;  // the ground is Crossgait's
  info.capabilities.allocates = true;
  info.capabilities.precision = Precision::kFloat32;
  return info;
}

class PhysxBackend final : public PhysicsBackend, public LosableWorld {
 public:
  PhysxBackend(const WorldSpec& world, const Settings& settings)
      : PhysicsBackend(world), settings_(settings), info_(make_info(settings)), couplings_(spec()) {
    build();
    reset();
  }

  ~PhysxBackend() override { clear(); }
  PhysxBackend(const PhysxBackend&) = delete;
  PhysxBackend& operator=(const PhysxBackend&) = delete;

  const EngineInfo& info() const override { return info_; }
  void throw_if_lost() const override { refuse_fork(); }

 private:
  void clear() {
    model_.reset();
    contacts_.reset();
    scene_.reset();
  }

  void build() {
    clear();
    contacts_ = std::make_unique<StepContacts>(spec(), settings_);
    px::PxPhysics& physics = the_physics();
    px::PxSceneDesc description(physics.getTolerancesScale());
    description.gravity = {static_cast<float>(spec().gravity.x()), static_cast<float>(spec().gravity.y()),
                           static_cast<float>(spec().gravity.z())};
    description.cpuDispatcher = &dispatcher_;
    description.filterShader = only_ground;
    description.simulationEventCallback = contacts_.get();
    description.solverType = settings_.temporal ? px::PxSolverType::eTGS : px::PxSolverType::ePGS;
    description.flags = px::PxSceneFlag::eENABLE_ENHANCED_DETERMINISM;
    description.flags |= px::PxSceneFlag::eENABLE_FRICTION_EVERY_ITERATION;
    scene_.reset(physics.createScene(description));
    if (scene_ == nullptr) throw std::runtime_error("PhysX refused a scene");
    model_ = std::make_unique<ArticulationModel>(spec(), settings_, *scene_);
    contacts_->build(*scene_, *model_);
    poisoned_ = false;
    if (!couplings_.empty()) {
      torques_ = tried_.q = tried_.qd = JointVector::Zero(robot().joint_count());
      model_->save(start_);
    }
  }

  void do_reset(const RobotState& state) override {
    refuse_fork();
    if (poisoned_) build();
    contacts_->forget();
    couplings_.forget();
    model_->set_state(state);
  }

  StepStatus do_step(const JointVector& tau, const Wrench& base) noexcept override {
    if (is_fork()) return StepStatus::kDiverged;
    if (!(tau.size() == 0 || tau.lpNorm<Eigen::Infinity>() < kMost) || !(base.force.norm() < kMost) ||
        !(base.torque.norm() < kMost))
      return StepStatus::kDiverged;
    push_ = base.force;
    model_->recentre();
    if (couplings_.empty()) {
      simulate(tau, base);
    } else {
      simulate_coupled(tau, base);
    }
    return poisoned_ ? StepStatus::kDiverged : StepStatus::kOk;
  }

  void simulate(const JointVector& tau, const Wrench& base) noexcept {
    model_->apply(tau, implicit_servos(), base);
    contacts_->begin_step(*scene_, *model_);
    scene_->simulate(static_cast<float>(spec().physics_dt));
    scene_->fetchResults(true);
    poisoned_ = !model_->take();
  }

  void simulate_coupled(const JointVector& tau, const Wrench& base) noexcept {
    model_->get_state(tried_);
    couplings_.begin(tried_.q);
    model_->save(start_);
    for (;;) {
      torques_ = tau;
      couplings_.add_torques(torques_);
      simulate(torques_, base);
      if (poisoned_) return;
      model_->get_state(tried_);
      if (couplings_.settle(tried_.q)) return;
      model_->restore(start_.data());
    }
  }

  void do_read_state(RobotState& state) const noexcept override { model_->get_state(state); }
  void do_read_contacts(ContactList& contacts) const noexcept override {
    contacts_->read(*model_, push_, contacts);
  }

  double do_terrain_height(double x, double y) const override {
    return spec().terrain.contains(x, y) ? spec().terrain.height(x, y)
                                         : std::numeric_limits<double>::quiet_NaN();
  }

  Pose do_body_pose(int body) const override { return model_->body_pose(body); }
  Eigen::MatrixXd do_mass_matrix() const override { return model_->mass_matrix(); }
  SpatialInertia do_body_inertia(int body) const override { return model_->body_inertia(body); }

  JointRanges do_joint_limits() const override {
    JointRanges ranges(robot().joint_count());
    for (int i = 0; i < robot().joint_count(); ++i) {
      if (const auto limits = model_->joint_limits(i)) std::tie(ranges.lower[i], ranges.upper[i]) = *limits;
    }
    return ranges;
  }

  JointVector do_joint_friction() const override {
    JointVector friction(robot().joint_count());
    for (int i = 0; i < robot().joint_count(); ++i) friction[i] = model_->joint_friction(i);
    return friction;
  }

  void do_save(std::vector<double>& engine) const override {
    model_->save(engine);
    couplings_.save(engine);
  }
  void do_restore(const std::vector<double>& engine) override {
    refuse_fork();
    if (poisoned_) build();
    contacts_->forget();
    model_->restore(engine.data());
    couplings_.restore(engine.data() + engine.size() - static_cast<std::size_t>(couplings_.state_size()));
  }

  Settings settings_;
  EngineInfo info_;
  InlineDispatcher dispatcher_;
  std::unique_ptr<px::PxScene, Release> scene_;
  std::unique_ptr<StepContacts> contacts_;
  std::unique_ptr<ArticulationModel> model_;
  CoupledJoints couplings_;
  RobotState tried_;                // as a try of a step with couplings left it
  JointVector torques_;             // of that try, N m
  std::vector<double> start_;       // what the step began with, number by number
  Vector3 push_ = Vector3::Zero();  // of the last step, N
  bool poisoned_ = false;
};

}  // namespace

namespace {

constexpr std::string_view kOwnContact = "own_contact";

// The last factor of whole_family, behind all of those before it.
std::optional<Engine> find_own_contact(std::string_view name) {
  const std::string_view rest = name.substr(0, name.size() - kOwnContact.size() - 1);
  const std::optional<Engine> before = find_matched(rest);
  if (before && before->name() == law_table().on) return find(factor_table().on);
  throw ConfigError("engine", std::string(name), "own_contact behind all other factors of physx:matched",
                    std::string(rest));
}

}  // namespace

std::optional<Engine> find(std::string_view name) {
  if (name.starts_with("physx:") && name.ends_with("+own_contact")) return find_own_contact(name);
  if (std::optional<Engine> matched = find_matched(name)) return matched;
  const std::optional<Settings> settings = find_settings(name);
  if (!settings) return std::nullopt;
  if (!settings->solver) return shared_engine(*settings);
  return Engine{make_info(*settings), [settings = *settings](const WorldSpec& spec) {
                  return std::make_unique<PhysxBackend>(spec, settings);
                }};
}

EngineFamily family() { return contact::family_of(factor_table(), find); }

EngineFamily whole_family() {
  EngineFamily family = law_family();
  ModelFactor own{
      "own_contact", "PhysX's own contact, loops and solver: all between physx:hard and physx", {}};
  for (const ModelFactor& factor : family.factors) own.needs.push_back(factor.name);
  family.factors.push_back(own);
  family.to = factor_table().on;
  family.with = [laws = family.with](std::vector<std::string> names) {
    return std::erase(names, kOwnContact) > 0 ? *find(factor_table().on) : laws(names);
  };
  return family;
}

}  // namespace crossgait::physx
