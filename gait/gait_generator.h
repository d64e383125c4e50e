// Foot targets of one gait over time, continuous through every change of parameters, gait and command.
#pragma once

#include <optional>

#include "gait/foot_trajectory.h"
#include "gait/gait.h"
#include "gait/phase_clock.h"
#include "gait/velocity_command.h"

namespace crossgait {

/// Says what one foot should do now.
struct FootTarget {
  Vector3 position = Vector3::Zero();  ///< foot centre in the leg frame (x forward, y left, z up), m
  bool swing = false;                  ///< in the air
  double phase = 0;                    ///< of the leg, since its lift-off, in [0, 1)
  double progress = 0;                 ///< of its swing or stance, 0 to 1
};

/// Runs one gait. Steps are step_length forward, or those of a velocity command once there is one.
///
/// **Continuity.** In one update no target moves further than 1.5 times the gait's top foot speed times dt,
/// whatever was set before. Changes of parameters and steps therefore take effect gradually if they would
/// move a foot faster than kShiftShare of that speed (at once if no foot has to move for them); the legs of a
/// new gait run up to kPhaseShare faster or slower until they are in step. `effective()` tells how far it is.
/// A change of the cycle time alone moves no foot, so it acts at once; the phase stays.
class GaitGenerator {
 public:
  enum class Start {
    kWalking,   ///< in full stride at phase 0, as the guide's controllers
    kStanding,  ///< all feet below their shoulders; the stride grows from there
  };

  /// @param p_BL  origins of the leg frames in the base frame, m: where a foot is, to turn about the base
  /// @throws ConfigError if gait, parameters or limits are not valid
  GaitGenerator(const Gait& gait, const GaitParameters& parameters, const LegArray<Vector3>& p_BL,
                const StepLimits& limits = {});

  /// Goes back to phase 0 with the gait, parameters and command last set, all in effect at once.
  void reset(Start start = Start::kWalking) noexcept;

  /// @returns false, changing nothing, if they are not valid
  [[nodiscard]] bool set_parameters(const GaitParameters& parameters) noexcept;
  /// Changes to another gait, with its preferred duty factor. The clock is set so that the legs have least to
  /// catch up. The gait must be valid.
  void set_gait(const Gait& gait) noexcept;
  /// Walks as commanded; at (nearly) zero velocity it stands.
  /// @returns false, changing nothing, if it is not finite
  [[nodiscard]] bool set_command(const VelocityCommand& command) noexcept;
  /// Goes back to steps of step_length.
  void clear_command() noexcept;
  /// Turns besides, at this yaw rate (rad/s), wherever steps lead: for heading control. It alone starts no
  /// walk. Clamped; not finite: 0.
  void set_steering(double yaw_rate) noexcept;

  /// Sets how far a foot's centre sweeps for each metre that the body is to advance, forward and sideways:
  /// less than 1 for feet that roll as their legs turn (FootTargetTracker::rolling_correction). Steps are
  /// advances of the body. To be set while standing. @param sweep  positive
  void set_rolling_correction(const Vector2& sweep) noexcept { rolling_correction_ = sweep; }

  /// Advances by dt (s) and returns the targets. Without effect unless dt is positive and finite.
  const LegArray<FootTarget>& update(double dt) noexcept;

  const LegArray<FootTarget>& targets() const noexcept { return targets_; }
  const Gait& gait() const noexcept { return gait_; }
  /// Returns the parameters as last set.
  const GaitParameters& parameters() const noexcept { return wanted_; }
  /// Holds what moves the feet: parameters, steps and lift as far as they have taken effect.
  struct Stride {
    GaitParameters parameters;
    LegArray<Vector2> step = no_steps();  ///< m
    double lift_scale = 1;                ///< 0 standing to 1
  };
  const Stride& effective() const noexcept { return effective_; }
  /// Returns the phase of the gait's clock, in [0, 1).
  double phase() const noexcept { return clock_.phase(); }
  std::string_view current_phase_name() const noexcept { return phase_name(gait_, clock_.phase()); }
  /// Returns the fraction of the command that the steps can follow, in (0, 1]; 1 without a command.
  double limit_factor() const noexcept { return limit_factor_; }
  /// Stands still: no foot moves until something changes.
  bool is_standing() const noexcept;
  /// Returns false while legs are still on their way to a new gait.
  bool in_step() const noexcept { return in_step_; }

  /// Shares of the top foot speed, see above. Their sum with the gait's own motion stays below 1.5.
  static constexpr double kShiftShare = 0.45;        ///< for changes of stride, once in step
  static constexpr double kShiftShareInTurn = 0.15;  ///< for changes of stride while changing the gait
  static constexpr double kPhaseShare = 0.2;         ///< for legs on their way to a new gait

 private:
  Stride wanted_stride() noexcept;
  void approach(const Stride& wanted, double dt) noexcept;
  double largest_shift(const Stride& candidate) const noexcept;
  double shift_speed(const Stride& wanted) const noexcept;
  void turn_to_gait(double cycles) noexcept;
  void adopt_gait() noexcept;
  void begin_cycle(const GaitParameters& wanted) noexcept;
  void place_feet() noexcept;
  LegPhase phase_of(Leg leg, const Stride& stride) const noexcept;
  Vector3 position_of(Leg leg, const Stride& stride, const LegPhase& phase) const noexcept;

  Gait gait_;
  GaitParameters wanted_;
  LegArray<Vector3> p_BL_;
  StepLimits limits_;
  std::optional<VelocityCommand> command_;
  double steering_ = 0;  // rad/s
  Vector2 rolling_correction_{1, 1};

  PhaseClock clock_;
  LegArray<double> offset_ = {};
  LegArray<SwingCurve> curve_ = {};
  Stride effective_;
  LegArray<FootTarget> targets_ = {};
  double limit_factor_ = 1;
  bool stepping_ = true;  ///< as opposed to standing or coming to a stand
  bool settled_ = false;  ///< `effective_` is what is wanted
  bool in_step_ = true;
};

}  // namespace crossgait
