// What an environment says of the robot's joints: how its servos are set, and what a joint action means.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "physics/robot/joint_numbers.h"
#include "physics/robot/robot.h"

namespace crossgait {

/// Name of the servos that are not named beside it in a file.
inline constexpr std::string_view kAllServos = "all";

/// Holds one number for every servo, numbers for some of them by the joint's name, or nothing.
struct ServoNumbers {
  std::optional<double> all;
  std::map<std::string, double> by_name;

  bool empty() const noexcept { return !all && by_name.empty(); }
  std::optional<double> find(const std::string& joint) const;

  bool operator==(const ServoNumbers&) const = default;
};

/// Describes the servos that a policy was made for, in the place of the robot's own; what is empty stays.
struct ServoSettings {
  std::array<ServoNumbers, kJointNumbers.size()> numbers;  ///< in the order of kJointNumbers, in its units

  /// Returns the numbers by the name of their row, "kp". @throws ConfigError listing the known names
  ServoNumbers& operator[](std::string_view name);

  bool empty() const noexcept;
  /// @throws ConfigError naming `source` for a name that is no servo's, or a value that no servo can have
  void apply(RobotDescription& robot, std::string_view source) const;

  bool operator==(const ServoSettings&) const = default;
};

/// Says what an action of joints means.
enum class JointCommand {
  kPosition,  ///< target = offset + scale x action
  kRelative,  ///< target = angle at the action's instant + scale x action
  kTorque,    ///< the servo's torque = scale x action, within its effort
  kVelocity,  ///< the servo's torque = kd (scale x action - joint velocity), within its effort
};
/// Names a command: "position", "relative", "torque", "velocity".
std::string_view name(JointCommand command) noexcept;

/// Describes an action that commands joints.
struct JointActionSettings {
  std::vector<std::string> order;  ///< of the servos in actions and observations; empty: the robot's
  /// Joints that observations show, in their order, with or without servos; empty: as `order`.
  std::vector<std::string> observed;
  JointCommand command = JointCommand::kPosition;
  std::map<std::string, JointCommand> commands;  ///< of joints with another one than `command`
  std::string
      actuator;       ///< file of a network that makes torques of targets (policy/actuator_network.h), or ""
  ServoNumbers home;  ///< rad; of what is not said, the robot's home pose
  ServoNumbers offset;             ///< of position targets, rad; of what is not said, home
  ServoNumbers scale = {0.5, {}};  ///< rad; of torques N m, of velocities rad/s
  ServoNumbers lower, upper;       ///< targets are clipped to them, in their unit; nothing: not clipped
  double limit = 1;                ///< actions are clipped to +-limit
  double delay = 0;                ///< from an action to its targets, s; whole control steps
  double filter = 1;  ///< share of the new in targets, in (0, 1]; the rest stays of the last ones

  /// Tells whether servos are made to give torques: of an action, for a velocity, or of a network.
  bool commands_torques() const noexcept;
  /// The same of one joint.
  bool computes_torque(const std::string& joint) const;
  JointCommand command_of(const std::string& joint) const;

  bool operator==(const JointActionSettings&) const = default;
};

/// Holds an action of joints read against a robot: numbers in the order of the action.
struct JointActionTable {
  std::vector<int> servos;                        ///< joint indices
  std::vector<Eigen::Index> slots;                ///< of those in JointTargets
  std::vector<double> home, scale;                ///< rad; of torques N m, of velocities rad/s
  std::vector<double> offset = {};                ///< rad; empty: home
  std::vector<double> lower = {}, upper = {};     ///< in the unit of targets, infinite where nothing clips
  std::vector<JointCommand> commands = {};        ///< empty: of positions
  std::vector<int> observed = {};                 ///< joint indices, in the order of observations
  std::vector<double> observed_home = {};         ///< rad
  std::vector<Eigen::Index> observed_slots = {};  ///< in JointTargets; -1 of a joint without a servo

  /// Says what a number of the action means: "0.5 rad from 0.900".
  std::string target_unit(std::size_t i) const;

  /// @throws ConfigError naming `source` unless `order` holds every servo of the robot once, `observed`
  /// joints of it, every other name is a servo's, and home lies within the joints' limits
  static JointActionTable make(const JointActionSettings& settings, const RobotDescription& robot,
                               std::string_view source);
};

/// Says "rad from 0.900".
std::string measured_from(std::string_view unit, double zero);

}  // namespace crossgait
