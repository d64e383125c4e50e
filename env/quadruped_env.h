// The reinforcement-learning environment: a robot whose gait a policy adjusts, or whose joints it commands.
#pragma once

#include <memory>
#include <span>
#include <variant>

#include "env/env_model.h"
#include "env/foot_times.h"
#include "env/gait_control.h"
#include "env/joint_control.h"
#include "motion/closed_loop.h"
#include "physics/core/random.h"
#include "physics/engine/engine.h"
#include "physics/engine/world_quantities.h"

namespace crossgait {

struct StepResult {
  double reward = 0;
  bool terminated = false;  ///< an outcome of EnvConfig::terminations came about, or the engine diverged
  bool truncated = false;   ///< the episode's time is over
  bool done() const noexcept { return terminated || truncated; }
};

/// Holds what the last step did, beside the observation.
struct StepInfo {
  double time = 0;                           ///< of the episode, s
  std::optional<GaitParameters> parameters;  ///< as adapted so far, where actions adapt a gait
  RewardTerms reward_terms{};                ///< weighted; order of `reward_terms()`
  LegArray<FootContact> contacts{};
  LegArray<bool> swing{};
  double distance = 0,
         lateral = 0;  ///< of the base since the episode began, along and left of its heading then, m
  Vector3 roll_pitch_yaw = Vector3::Zero();  ///< rad, yaw since the episode began
  double power = 0;                          ///< of the servos, mean over the last step, W
  double limit_factor = 1;                   ///< share of the velocity command that the steps follow
  int ik_clamped = 0;                        ///< leg solutions of this step that were not exact
  int invalid_actions = 0;             ///< entries of the action that were not finite and counted as zero
  int clipped_actions = 0;             ///< entries that were beyond their bounds
  Outcome outcome = Outcome::kWalked;  ///< the worst so far of those that are known at once
};

/// Runs one environment: one world, one thread; its actions are of either kind (EnvConfig::action). The same
/// configuration, seed and actions give the same observations bit for bit, after `reset` as after `restore`.
class QuadrupedEnv {
 public:
  /// Builds the world, unless the configuration randomises it; nothing moves before `reset`.
  /// @param group  of the environments that are stepped together; null: none
  /// @throws ConfigError for a world that cannot be built
  QuadrupedEnv(std::shared_ptr<const EnvModel> model, Engine engine,
               std::shared_ptr<WorldGroup> group = nullptr);
  /// Makes an environment with a model of its own. @throws ConfigError for a bad configuration besides
  QuadrupedEnv(const LoadedEnv& loaded, Engine engine);
  ~QuadrupedEnv() = default;
  QuadrupedEnv(const QuadrupedEnv&) = delete;
  QuadrupedEnv& operator=(const QuadrupedEnv&) = delete;

  const EnvModel& model() const noexcept { return *model_; }
  const EnvConfig& config() const noexcept { return model_->config; }
  const Engine& engine() const noexcept { return engine_; }
  const Layout& observation_layout() const noexcept { return interface().observation; }
  const Layout& action_layout() const noexcept { return interface().action; }
  /// Describes what a policy for this environment runs on.
  const PolicyInterface& interface() const noexcept { return model_->interface; }
  std::size_t observation_size() const noexcept { return interface().observation.size(); }
  std::size_t action_size() const noexcept { return interface().action.size(); }

  /// Begins an episode: draws what is randomised, settles, and writes the first observation. Builds a world
  /// anew if the configuration randomises it. @throws ConfigError for a wrong size or an impossible draw
  void reset(std::uint64_t seed, std::span<double> observation);

  /// Makes one policy step. Entries of the action are clipped to their layout's bounds; not finite counts as
  /// zero. After the end of an episode nothing moves until `reset`: the last observation again, no reward,
  /// the same flags.
  /// @throws ConfigError for a wrong size or before the first `reset` (before anything changes)
  StepResult step(std::span<const double> action, std::span<double> observation);

  /// Returns what is known of the last step; of the start after `reset`.
  const StepInfo& info() const noexcept { return episode_.info; }
  /// Returns the world. @throws ConfigError before the first `reset` where the configuration randomises it
  const PhysicsBackend& world() const {
    if (world_ == nullptr) require_begun("world");
    return *world_;
  }
  /// Returns the gait that actions adapt; null where they command joints.
  const AdaptiveGaitController* gait() const noexcept;
  const FootStates& feet() const noexcept { return feet_; }
  const FootTimes& foot_times() const noexcept { return episode_.foot_times; }
  /// Returns joint velocities after the last policy step less those before it, over its time, rad/s^2.
  const JointVector& joint_acceleration() const noexcept { return episode_.joint_acceleration; }
  /// Returns the last step's action and that of the one before, clipped; zeros before the first.
  std::span<const double> action() const noexcept { return episode_.action; }
  std::span<const double> last_action() const noexcept { return episode_.last_action; }
  const VelocityCommand& command() const noexcept { return episode_.command; }
  /// Returns the height of the base's origin over the ground below it, m.
  double height() const noexcept { return episode_.loop.statistics().height(); }
  /// Tells whether there has been a `reset`.
  bool begun() const noexcept { return episode_.begun; }
  /// Returns the program's terms, or null.
  const EnvExtension* extension() const noexcept { return extension_.get(); }
  /// Says how the last step ended; neither flag before the first.
  const StepResult& result() const noexcept { return episode_.result; }
  const ControlTargets& targets() const noexcept { return episode_.loop.targets(); }
  /// Sums up the episode so far. @throws ConfigError as `world` does
  MotionSummary summary() const { return episode_.loop.statistics().summary(world()); }

  /// Asks for another velocity from the next step on. @throws ConfigError if it is not finite
  void set_command(const VelocityCommand& command);

  // Between steps of an episode, whatever the engine. All throw ConfigError before the first `reset`, and but
  // for `set_changes` where the episode has ended.

  /// Puts the robot into a state; the episode's time goes on. Contacts, and targets that were on their way to
  /// a servo, are forgotten, and neither way nor turn counts as made. The next observation shows it.
  /// @throws ConfigError as PhysicsBackend::reset does
  void set_state(RobotState state);
  /// Lets a wrench act on a body during the next step. @throws ConfigError as PhysicsBackend::apply_wrench
  void apply_wrench(const BodyWrench& wrench);
  /// Changes the world, in place of all changes before, for this episode and those that follow: what the
  /// configuration says or has drawn, with `changes` on top. The world is built anew and goes on as it was;
  /// with the values that it had, bit for bit. What knows the robot beside the world stays nominal.
  /// @throws ConfigError for a quantity that cannot change within an episode (physics_dt, delay), and as
  /// Engine::make does
  void set_changes(std::vector<QuantityChange> changes);
  std::span<const QuantityChange> changes() const noexcept { return changes_; }
  /// Lets the next `reset` begin the first episode again, for the program's terms: what they keep, and what
  /// they have changed for the episodes that follow, is as at the beginning.
  void forget();
  /// Ends the episode now: as an outcome would, or as its time would.
  void end_episode(bool terminated);
  /// The same of the step that was just made, as `EnvExtension::step` has it: a failure costs what the
  /// reward's `termination` says. @returns the step's reward by the table
  double end_in_step(bool terminated);
  /// Writes the first observation anew, of what was set since `reset`. @throws ConfigError for a wrong size,
  /// or after the first step
  void observe_start(std::span<double> observation);

  struct Saved;
  /// Saves everything that the rest of the episode depends on. @throws ConfigError before the first `reset`
  std::shared_ptr<const Saved> save() const;
  /// Continues where `saved` was, bit for bit. @throws ConfigError if it is of another configuration or
  /// engine
  void restore(const Saved& saved);

 private:
  // The episode's control, watched: what its legs could not solve is counted, and it is looked at between.
  class Watched final : public Controller {
   public:
    explicit Watched(QuadrupedEnv& env) : env_(env) {}
    RobotState initial_state(const Terrain& terrain, const Placement& placement) const override;
    void hold_pose(double dt, ControlTargets& out) override;
    void advance(double dt, ControlTargets& out) override;
    void observe(const RobotState& state, double dt) override;

   private:
    QuadrupedEnv& env_;
  };

  // What changes from step to step, beside the engine.
  struct Episode {
    std::variant<GaitControl, JointControl> control;
    ClosedLoop loop;
    Observer observer = {};
    Random random{0};
    std::uint64_t seed = 0;
    VelocityCommand command = {};
    std::vector<double> action = {}, last_action = {}, parameters = {}, last_parameters = {},
                        last_observation = {};
    FootTimes foot_times = {};
    JointVector joint_acceleration = {};
    RandomDraw draw{};
    int steps = 0, control_steps = 0;  // the latter of this policy step
    bool begun = false;
    StepResult result = {};
    StepInfo info = {};
  };

  std::unique_ptr<PhysicsBackend> make_world(WorldSpec spec) const;
  Episode make_episode() const;
  Controller& control() noexcept;
  WorldSpec draw_world();
  Start draw_start() const;
  void take_action(std::span<const double> action) noexcept;
  void finish_step(const RobotState& before, const MotionIntegrals& integrals_before);
  void measure();
  void terminate();
  double evaluate(const RobotState& before, const MotionIntegrals& during);
  ObservationSource seen() const noexcept;
  void observe_substep();
  void observe(std::span<double> observation);
  void require_begun(std::string_view what) const;
  void require_going(std::string_view what) const;

  std::shared_ptr<const EnvModel> model_;
  Engine engine_;
  std::shared_ptr<WorldGroup> group_;
  FootStates feet_;
  WorldSpec base_world_;  // as configured or drawn, without changes
  std::vector<QuantityChange> changes_;
  std::unique_ptr<PhysicsBackend> world_;
  std::unique_ptr<EnvExtension> extension_;
  Episode episode_;
  Watched watched_{*this};
};

struct QuadrupedEnv::Saved {
  Episode episode;
  WorldSpec world, base_world;
  std::vector<QuantityChange> changes;
  Snapshot physics;
  std::shared_ptr<const void> extension;
  std::shared_ptr<const EnvModel> model;  ///< to refuse another configuration's
};

}  // namespace crossgait
