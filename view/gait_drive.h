// A gait that is driven while it runs: velocity, gait and parameters change under way.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "gait/multi_gait_controller.h"
#include "motion/gait_walker.h"

namespace crossgait {

/// Bounds what a driver may ask of a robot: commands, either way.
struct DriveLimits {
  double forward = 0;   ///< m/s
  double left = 0;      ///< m/s
  double yaw_rate = 0;  ///< rad/s
  double push = 0;      ///< N s
};

/// Returns gaits' speeds at the robot's size, and pushes that change its speed by 1 m/s at most (scaled).
DriveLimits drive_limits(const RobotDescription& robot) noexcept;

/// @throws ConfigError for a command beyond them, or not finite
void check_drive(const RobotDescription& robot, const VelocityCommand& command);

/// Returns what a parameter may be set to: the table's range at the robot's size, wide enough for what every
/// gait prefers. @throws ConfigError for an unknown name
AdaptationRanges::Interval parameter_range(std::string_view name, const GaitScale& scale);

/// Drives a gait as a value: a copy drives another robot on from there, in the same phase of the gait.
class GaitDrive final : public GaitWalker<GaitGenerator> {
 public:
  /// Stands the robot. @throws ConfigError for an unknown gait, or a robot without legs that can be driven
  GaitDrive(const WorldSpec& world, const std::string& gait);

  /// @throws ConfigError beyond `drive_limits`, or not finite
  void set_command(const VelocityCommand& command);
  /// Changes over to a gait with the parameters that it prefers, or to whichever suits the speed
  /// (`is_automatic`). @throws ConfigError for an unknown name
  void set_gait(const std::string& gait);
  /// Sets a parameter; where the gait is chosen by speed, of every one of them. @throws ConfigError for an
  /// unknown name, or a value outside `parameter_range`
  void set_parameter(const std::string& name, double value);
  /// Sets the curve of the swing, likewise. @throws ConfigError for an unknown name
  void set_curve(const std::string& curve);
  /// Goes back to standing, with gait and parameters as they are and no command.
  void restart();

  /// Returns what `set_gait` was told.
  const std::string& chosen_gait() const noexcept { return chosen_; }
  const VelocityCommand& command() const noexcept { return command_; }

 private:
  /// Changes over to the gait for the speed. @returns its parameters
  GaitParameters chosen_by_speed();
  /// Walks with the driver's settings in their places.
  void walk_as(const GaitParameters& parameters);

  std::shared_ptr<const RobotDescription> robot_;
  GaitScale scale_;
  std::string chosen_;
  /// Asked for gait and parameters at every command, and for nothing else; none where the gait is chosen by
  /// hand.
  std::optional<MultiGaitController> by_speed_;
  GaitSettings settings_;  ///< of the driver, since the gait was chosen
  VelocityCommand command_;
};

}  // namespace crossgait
