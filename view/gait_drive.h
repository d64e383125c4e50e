// A gait that is driven while it runs: velocity, gait and parameters change under way.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "crossgait/env/gait_source.h"

namespace crossgait {

/// What a driver may ask of a robot: bounds of commands, either way.
struct DriveLimits {
  double forward = 0;   ///< m/s
  double left = 0;      ///< m/s
  double yaw_rate = 0;  ///< rad/s
  double push = 0;      ///< N s
};

/// As fast as the gaits go at the robot's size, and pushes that change its speed by 1 m/s at most (scaled).
DriveLimits drive_limits(const RobotDescription& robot) noexcept;

/// @throws ConfigError for a command beyond them, or not finite
void check_drive(const RobotDescription& robot, const VelocityCommand& command);

/// What a parameter may be set to: the table's range at the robot's size, wide enough for what every gait
/// prefers. @throws ConfigError for an unknown name
AdaptationRanges::Interval parameter_range(std::string_view name, const GaitScale& scale);

/// A value: a copy drives another robot on from there, in the same phase of the gait.
class GaitDrive {
 public:
  /// Stands. @throws ConfigError for an unknown gait, or a robot without legs that can be driven
  GaitDrive(std::shared_ptr<const RobotDescription> robot, const std::string& gait);

  /// @throws ConfigError beyond `drive_limits`, or not finite
  void set_command(const VelocityCommand& command);
  /// Changes over to a gait with the parameters that it prefers. @throws ConfigError for an unknown name
  void set_gait(const std::string& gait);
  /// @throws ConfigError for an unknown name, or a value outside `parameter_range`
  void set_parameter(const std::string& name, double value);
  /// Back to standing, with gait and parameters as they are and no command.
  void restart();

  const VelocityCommand& command() const noexcept { return command_; }
  const GaitGenerator& generator() const noexcept { return generator_; }

  /// The functions of a TargetSource.
  RobotState stand(const Terrain& terrain, const Placement& placement) const {
    return legs_.standing_state(standing_, terrain, placement);
  }
  void hold(double dt, ControlTargets& out) noexcept { solve_legs(legs_, standing_, dt, out); }
  void look(const RobotState& state, double dt) noexcept;
  void advance(double dt, ControlTargets& out) noexcept;

 private:
  std::shared_ptr<const RobotDescription> robot_;
  GaitScale scale_;
  HeadingHold hold_heading_;
  HeadingHoldState heading_;
  LegController legs_;
  GaitGenerator generator_;
  VelocityCommand command_;
  LegArray<Vector3> standing_{};  // feet before the first step, in the leg frames, m
};

}  // namespace crossgait
