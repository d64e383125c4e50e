// The servos of a robot with what stands between a target and its torque. One code for every engine.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "physics/robot/implicit_servo.h"
#include "physics/robot/robot.h"
#include "physics/robot/state.h"

namespace crossgait {

/// Puts targets on their way (Joint::delay, Joint::lag) and errors of measurement
/// (Joint::sensor_noise) over the servo law. Targets are clipped (Joint::lower, Joint::target_lower),
/// delayed, and then followed: what a servo holds comes nearer to its target by the factor exp(-dt /
/// lag) a step (MuJoCo's `filterexact`, which acts from the next step on). A value: a copy goes on
/// from there.
class Drives {
 public:
  Drives() = default;
  /// @throws ConfigError if a servo's delay is no whole number of steps of `physics_dt` (s), or too many
  Drives(const RobotDescription& robot, double physics_dt);

  /// Takes the next targets to have been on their way for ever.
  void restart() noexcept { steps_ = 0; }
  /// Adds the torques of the servos in the next physics step, but for those that are implicit (actuator.h):
  /// see `implicit`.
  /// @param targets  of RobotDescription::actuated_joints(), rad
  void add_torques(const JointTargets& targets, const RobotState& state, JointVector& torques) noexcept;
  /// Returns what the others do in the step whose torques were asked for last.
  std::span<const ImplicitServo> implicit() const noexcept { return implicit_; }

  /// Appends all that the rest depends on to `out`.
  void save(std::vector<double>& out) const;
  /// Tells whether `save` of drives of the same robot and step may have written that.
  bool can_restore(const std::vector<double>& saved) const noexcept;
  /// @param saved  what `can_restore` is true of
  void restore(const std::vector<double>& saved);

 private:
  struct Servo {
    int index;          // of its joint
    std::size_t delay;  // physics steps
    double left;        // of the way to a target after one step, for its lag
    Joint joint;
  };

  std::vector<Servo> servos_;
  std::vector<JointVector> line_;  // targets of the last steps, this one's included
  JointVector held_;               // what servos with a lag hold now
  std::uint64_t steps_ = 0;        // since the restart
  double physics_dt_ = 0;          // s
  std::vector<ImplicitServo> implicit_;
};

}  // namespace crossgait
