// The reinforcement-learning environment: a gait whose parameters and foot targets a policy adjusts.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "crossgait/env/env_config.h"
#include "crossgait/env/leg_controller.h"
#include "crossgait/env/policy.h"
#include "crossgait/env/random.h"
#include "crossgait/physics/engine.h"

namespace crossgait {

struct StepResult {
  double reward = 0;
  bool terminated = false;  ///< fell, left the terrain, or the engine diverged
  bool truncated = false;   ///< the episode's time is over
  bool done() const noexcept { return terminated || truncated; }
};

/// What the last step did, beside the observation.
struct StepInfo {
  double time = 0;             ///< of the episode, s
  GaitParameters parameters;   ///< as adapted so far
  RewardTerms reward_terms{};  ///< weighted; order of `reward_terms()`
  LegArray<FootContact> contacts{};
  LegArray<bool> swing{};
  double distance = 0,
         lateral = 0;  ///< of the base since the episode began, along and left of its heading then, m
  Vector3 roll_pitch_yaw = Vector3::Zero();  ///< rad, yaw since the episode began
  double power = 0;                          ///< sum of |torque x velocity| of the servo joints, W
  double limit_factor = 1;                   ///< share of the velocity command that the steps follow
  int ik_clamped = 0;                        ///< leg solutions of this step that were not exact
  int invalid_actions = 0;  ///< entries of the action that were not finite and counted as zero
  bool fell = false, left_terrain = false, diverged = false;  ///< why the episode terminated
};

/// One environment: one world, one thread. The same configuration, seed and actions give the same
/// observations bit for bit, after `reset` as after `restore`.
class AdaptiveGaitEnv {
 public:
  /// @throws ConfigError for a bad configuration or a world that cannot be built
  AdaptiveGaitEnv(const EnvConfig& config, Engine engine);

  const EnvConfig& config() const noexcept { return config_; }
  const Layout& observation_layout() const noexcept { return interface_.observation; }
  const Layout& action_layout() const noexcept { return interface_.action; }
  /// What a policy for this environment runs on.
  const PolicyInterface& interface() const noexcept { return interface_; }
  std::size_t observation_size() const noexcept { return interface_.observation.size(); }
  std::size_t action_size() const noexcept { return interface_.action.size(); }

  /// Begins an episode: draws what is randomised, settles, and writes the first observation. Builds a world
  /// anew if the configuration randomises it. @throws ConfigError for a wrong size or an impossible draw
  void reset(std::uint64_t seed, std::span<double> observation);

  /// One policy step. Entries of the action are clipped to [-1, 1]; what is not finite counts as zero. After
  /// the end of an episode nothing moves until `reset`: the last observation again, no reward, the same
  /// flags.
  /// @throws ConfigError for a wrong size (before anything changes)
  StepResult step(std::span<const double> action, std::span<double> observation);

  /// Of the last step; of the start after `reset`.
  const StepInfo& info() const noexcept { return episode_.info; }
  const PhysicsBackend& backend() const noexcept { return *backend_; }
  const AdaptiveGaitController& controller() const noexcept { return episode_.controller; }
  const FootStates& feet() const noexcept { return feet_; }
  const JointTargets& targets() const noexcept { return episode_.targets; }

  /// Asks for another velocity from the next step on. @throws ConfigError if it is not finite
  void set_command(const VelocityCommand& command);

  struct Saved;
  /// Everything that the rest of the episode depends on.
  std::shared_ptr<const Saved> save() const;
  /// Continues where `saved` was, bit for bit. @throws ConfigError if it is of another configuration or
  /// engine
  void restore(const Saved& saved);

 private:
  // What changes from step to step, beside the engine.
  struct Episode {
    std::shared_ptr<const RobotDescription> robot;  // that `legs` was made for, also in a saved episode
    AdaptiveGaitController controller;
    LegController legs;
    Random random{0};
    JointTargets targets = {};
    VelocityCommand command = {};
    std::vector<double> action = {}, last_action = {}, parameters = {}, last_parameters = {};
    double start_yaw = 0, standing_height = 0, next_push = 0, weight = 0;
    Vector3 start = Vector3::Zero();
    RandomDraw draw{};
    int steps = 0;
    StepResult result = {};
    StepInfo info = {};
  };

  Episode make_episode() const;
  WorldSpec draw_world();
  void place_robot(const LegArray<Vector3>& feet);
  StepStatus control(double seconds) noexcept;
  void push_if_due() noexcept;
  void take_action(std::span<const double> action) noexcept;
  void read_parameters(std::vector<double>& out) const noexcept;
  void finish_step(const RobotState& before, StepStatus status) noexcept;
  void measure() noexcept;
  double evaluate(const RobotState& before) noexcept;
  void observe(std::span<double> observation) const noexcept;

  EnvConfig config_;
  Engine engine_;
  WorldSpec nominal_;  // its robot is what the controller knows
  std::vector<const ObservationBlock*> blocks_;
  std::vector<int> servos_;
  PolicyInterface interface_;
  int substeps_, max_steps_;
  FootKinematics foot_kinematics_;
  FootStates feet_;
  std::unique_ptr<PhysicsBackend> backend_;
  Episode episode_;
};

struct AdaptiveGaitEnv::Saved {
  Episode episode;
  WorldSpec world;
  Snapshot physics;
  std::string layout;  ///< hash, to refuse another configuration's
};

}  // namespace crossgait
