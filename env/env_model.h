// What every environment of one configuration shares: read and built once, never changed.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "env/loaded_env.h"
#include "env/observer.h"
#include "motion/foot_states.h"
#include "motion/heading_hold.h"
#include "policy/policy.h"

namespace crossgait {

struct EnvModel {
  EnvConfig config;
  std::shared_ptr<const RobotDescription> robot;  ///< as its file has it (LoadedEnv::robot)
  TerrainSource ground;                           ///< of other seeds too
  WorldSpec world;              ///< nominal; its robot, servos set, is what the controller knows
  GaitParameters parameters;    ///< at the start of an episode: the configured ones over the gait's own
  AdaptationRanges adaptation;  ///< at the robot's size
  double residual_scale = 0;    ///< m
  HeadingHold heading_hold;
  double size = 1;          ///< of the robot, in reference sizes (gait/scale.h)
  JointActionTable joints;  ///< servos in the order of joint actions, joints in that of observations
  std::shared_ptr<const ActuatorNetwork> actuator;  ///< that makes torques of targets, or null
  PolicyInterface interface;
  Observer observer;  ///< before an episode
  FootKinematics foot_kinematics;
  /// Smallest and largest value of each action: those of the layout, without its texts between them.
  std::vector<std::pair<double, double>> action_bounds;
  std::string layout;    ///< hash of the interface
  int policy_steps = 1;  ///< control steps in a policy step
  int max_steps = 0;     ///< policy steps in an episode

  /// Reads nothing that `loaded` has read. @throws ConfigError for a bad configuration
  static std::shared_ptr<const EnvModel> make(const LoadedEnv& loaded);

  /// Returns what the model was made of, from which others are made without reading the files again.
  LoadedEnv loaded() const;

  /// Returns the configuration with everything set that follows from the robot.
  EnvConfig resolved() const;
  /// Makes a gait's controller as it is before an episode.
  AdaptiveGaitController make_controller() const;
};

}  // namespace crossgait
