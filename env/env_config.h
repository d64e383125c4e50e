// Everything that makes an environment, as a struct and as a YAML file.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "env/env_extension.h"
#include "env/joint_settings.h"
#include "env/observation.h"
#include "env/randomisation.h"
#include "env/reward.h"
#include "env/start_settings.h"
#include "gait/gait.h"
#include "motion/outcome.h"
#include "physics/core/error.h"

namespace crossgait {

/// Says what an action changes.
enum class ActionKind {
  kGait,    ///< parameters and foot targets of a gait, by deltas and residuals
  kJoints,  ///< targets of the servos
};
/// Names a kind of action: "gait", "joints".
std::string_view name(ActionKind kind) noexcept;

/// Holds a configuration, whose initialisers are the defaults. `docs/environment.md` shows the same as YAML.
struct EnvConfig {
  std::string engine = "mujoco";          ///< see `crossgait engines`; used by whoever makes it
  std::string robot = "scara_quadruped";  ///< a bundled robot or a file
  std::string terrain = "flat";           ///< as `make_terrain` takes it
  std::uint64_t terrain_seed = 0;
  ContactSettings contact;  ///< over what the robot's file says

  ServoSettings servos;  ///< in the place of the robot's own
  ActionKind action = ActionKind::kGait;
  JointActionSettings joints;  ///< of actions that command joints; what follows, up to residual_scale, and
                               ///< heading_hold is of those that adapt a gait

  std::string gait = "trot";
  /// Sets the gait at the start of an episode; what is not set is as the gait prefers at the robot's size
  /// (EnvModel::parameters).
  GaitSettings parameters;
  std::vector<std::string> adapt = AdaptiveGaitOptions{}.parameters;  ///< parameters that the action changes
  AdaptationRanges adaptation;                                        ///< `ranges` and `delta_scales` of them
  std::optional<double> residual_scale;    ///< m; empty: 0.01 of the reference robot, by size
  std::optional<VelocityCommand> command;  ///< empty: steps of step_length, as the guide's
  bool heading_hold = true;                ///< steer to the heading that the command leads to

  std::vector<ObservationTerm> observation = standard_observation();
  ObservationSettings observing;  ///< `history`, `clock`, `height_scan`, `constants`
  RewardTerms reward = guide_reward_weights();

  double physics_dt = 1e-3;     ///< s
  double control_dt = 2e-3;     ///< gait, inverse kinematics, servo targets, s; a multiple of physics_dt
  double policy_dt = 2e-3;      ///< actions, observations and rewards, s; a multiple of control_dt
  double episode_seconds = 20;  ///< then an episode is truncated
  double settle_seconds = 0.5;  ///< standing before the first observation
  double tilt_limit_deg = 60;   ///< roll or pitch beyond it is a fall
  OutcomeSet terminations =
      OutcomeSet::of_episodes();  ///< outcomes that end an episode; divergence always does
  StartSettings start;            ///< how an episode begins where not standing
  Randomisation randomisation;

  /// Terms of the program's own, or null. YAML names them under `terms`, and cannot be read back.
  std::shared_ptr<const EnvExtensionModel> extension = nullptr;

  std::string source = "environment";  ///< the file that it was read from, for messages
  /// Says where a value of a file stands that is only found to be wrong when it is used.
  struct Place {
    std::string value, source, element;  ///< the text; the file; its line and key
  };
  std::vector<Place> places;  ///< of robot and terrain, where `load_env_config` read them

  /// @throws ConfigError naming `origin` and the field
  void validate(std::string_view origin = "environment") const;

  /// Returns what `make` makes of `value`, a member of this. What it throws names the line of the file that
  /// said so, if one did.
  template <typename Make>
  auto at_its_place(const std::string& value, const Make& make) const {
    try {
      return make();
    } catch (const ConfigError& error) {
      fail_at_its_place(value, error);
    }
  }

 private:
  [[noreturn]] void fail_at_its_place(const std::string& value, const ConfigError& error) const;
};

/// Returns the guide's environment: its trot, the ranges that its parameters adapt in, its delta scales.
EnvConfig guide_environment();
/// Returns an environment for policies that command joints, as usual: 20 ms policy steps, targets half a
/// radian about home, `joint_policy_observation`, a walk forward at `command`, and a reward for that.
EnvConfig joint_environment();

/// Reads a configuration; what the file does not mention keeps its default (parameters: the gait's
/// preferred). Files that it names are found from its own folder. Unknown keys and values are errors that
/// name the line. @throws ConfigError
EnvConfig load_env_config(const std::string& path);
/// Reads a configuration from text; `source` stands for the file in messages.
EnvConfig parse_env_config(const std::string& text, const std::string& source);
/// Returns `base` with what `text` says in the place of its own, key by key. `action` and `preset` are what a
/// configuration begins with, and no keys here. @throws ConfigError
EnvConfig override_env_config(const EnvConfig& base, const std::string& text, const std::string& source);
/// Writes the configuration as YAML that `parse_env_config` reads back unchanged. Files are named by their
/// whole path, so that it may be kept anywhere.
std::string to_yaml(const EnvConfig& config);

}  // namespace crossgait
