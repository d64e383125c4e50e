// One walk: a gait drives a robot in one engine for a while; what happened is summed up and can be watched.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "crossgait/env/leg_controller.h"
#include "crossgait/gait/gait_generator.h"
#include "crossgait/physics/physics_backend.h"

namespace crossgait {

/// Foot targets in the leg frames, m, after `dt` more seconds of gait. Asked with dt = 0 before the first
/// step, it says where the feet stand.
using FootTargetSource = std::function<LegArray<Vector3>(double dt)>;

/// Where a walk's foot targets come from.
struct GaitSource {
  FootTargetSource feet;
  /// The generator behind them, for its parameters and limits; empty for feet that come from elsewhere.
  std::function<const GaitGenerator&()> generator = {};
};

/// Timing of a walk. All in simulated seconds.
struct WalkTiming {
  double seconds = 5;  ///< of walking, s
  double control_dt =
      2e-3;  ///< gait, inverse kinematics and servo targets, s; a multiple of the physics step
  double settle_seconds = 0.5;  ///< standing before the first step, s

  /// Physics steps per control step. @throws ConfigError if not a whole number, or a time is negative or not
  /// finite
  int substeps(double physics_dt) const;
  /// Control steps of the walk proper.
  int control_steps() const;
};

/// What an observer sees after every control step. References are valid during the call alone.
struct WalkSample {
  const RobotState& state;
  const JointTargets& targets;
  const LegArray<FootContact>& feet;
  const GaitParameters* parameters =
      nullptr;  ///< of the gait, as last set; null if the feet come from elsewhere
};
/// @returns false to end the walk early
using WalkObserver = std::function<bool(const WalkSample&)>;

/// Statistics of the walk proper (without settling). Speeds are per simulated second, never per wall-clock
/// second.
struct WalkSummary {
  double simulated_seconds = 0;  ///< s, less than asked if the engine diverged
  std::int64_t physics_steps = 0;
  double distance_m = 0;      ///< forward, in the direction the robot faced when it set off
  double lateral_m = 0;       ///< to the left of that
  double yaw_rad = 0;         ///< change of heading, in (-pi, pi]
  double mean_speed_mps = 0;  ///< distance over simulated time
  Vector3 final_position_m = Vector3::Zero();
  double rms_roll_deg = 0, rms_pitch_deg = 0;
  bool fell = false;  ///< tilted by more than 60 degrees in roll or pitch
  std::optional<double> fell_at_s;
  bool diverged = false;         ///< the engine produced a state that is not one
  std::int64_t ik_clamped = 0;   ///< leg solutions that were not exact
  double limit_factor = 1;       ///< smallest share of the velocity command that the steps could follow
  double max_penetration_m = 0;  ///< of any contact
  double max_loop_gap_m = 0;
  LegArray<double> duty_factor{};  ///< share of time each foot carried load
  double slip_m = 0;               ///< path length that loaded feet slid, all four together
  double cost_of_transport =
      0;  ///< integral of |servo torque x joint velocity| over weight x distance; 0 if it did not move
  double wall_seconds = 0;  ///< of the whole call, settling included
};

/// Resets `backend`, restarts `legs` (made for the backend's robot), lets the robot settle, then walks.
/// @param start  where the robot is put down
/// @throws ConfigError for impossible timing
WalkSummary run_walk(PhysicsBackend& backend, LegController& legs, const GaitSource& gait,
                     const WalkTiming& timing, const WalkObserver& observer = {},
                     const LegController::Placement& start = {});

}  // namespace crossgait
