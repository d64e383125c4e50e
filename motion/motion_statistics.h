// What happened in a motion, in numbers: the same ones, under the same names, for walks, episodes and
// verdicts.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "motion/controller.h"
#include "motion/outcome.h"
#include "physics/core/heading.h"
#include "physics/engine/physics_backend.h"
#include "physics/robot/loop_gap.h"

namespace crossgait {

/// Holds statistics of a motion proper, without settling. Speeds are per simulated second, never per
/// wall-clock second. Each has a row in motion/statistic_rows.cpp.
struct MotionSummary {
  Outcome outcome = Outcome::kWalked;  ///< the worst that holds
  /// When each outcome that is known at once first held, s since the motion began.
  std::array<std::optional<double>, kOutcomes> first_at_s;

  double simulated_seconds = 0;  ///< s, less than asked if an outcome ended it
  std::int64_t physics_steps = 0;
  double distance_m = 0;  ///< forward, in the direction the robot faced when it set off
  double lateral_m = 0;   ///< to the left of that
  /// Way of the base over the ground, as the sum of straight pieces of half a second each, so that swaying
  /// within a stride does not count.
  double path_m = 0;
  double yaw_rad = 0;         ///< change of heading, in (-pi, pi]
  double mean_speed_mps = 0;  ///< distance over simulated time
  Vector3 final_position_m = Vector3::Zero();
  double rms_roll_deg = 0, rms_pitch_deg = 0;

  std::int64_t ik_clamped = 0;     ///< leg solutions that were not exact
  double limit_factor = 1;         ///< smallest share of the velocity command that the steps could follow
  double max_penetration_m = 0;    ///< of any contact
  double max_loop_gap_m = 0;       ///< looked at every 10 ms
  LegArray<double> duty_factor{};  ///< share of time each foot carried load
  double slip_m = 0;               ///< path length that loaded feet slid, all four together
  /// Share of planned swing time in which the foot carried more than a fiftieth of the weight, mean of legs;
  /// empty where no swing was planned.
  std::optional<double> swing_contact_ratio;
  /// The same without the first and last tenth of each swing, where a foot may touch and do no harm.
  std::optional<double> swing_contact_ratio_inner;
  /// `slip_m` over the way that planned stance feet were to sweep, all four together; empty where no plan or
  /// no way was asked for.
  std::optional<double> slip_per_path;
  /// Largest difference of the heading from where the command's yaw rate leads, deg; empty where nothing says
  /// what was asked for.
  std::optional<double> heading_error_deg;
  /// Mechanical work of the servos (`MotionIntegrals::work`) over weight times `path_m`; empty if the base
  /// moved less than a tenth of a leg length. Source: Tucker, The energetic cost of moving about, 1975.
  std::optional<double> cost_of_transport;

  double wall_seconds = 0;  ///< of the whole motion, settling included; set by whoever ran it

  bool has(Outcome which) const noexcept { return first_at_s[static_cast<std::size_t>(which)].has_value(); }
  /// Tells whether any outcome is a failure (`is_failure`).
  bool failed() const noexcept;
};

/// Sums up what jumps within a control step, at every physics step: torques jump when targets do, feet touch
/// down and lift off. One sample of it at the end of a control step says as much about that instant as about
/// the motion. Differences of two of these over `seconds` are the means between them.
struct MotionIntegrals {
  double seconds = 0;
  /// Mechanical work of the servos, J: |servo torque x mean joint velocity| of every physics step, over its
  /// time. A torque is constant over a step, and its velocity the mean of the step's both ends: so the work
  /// of all forces is the change of kinetic energy, exactly. The servo's torque, not the joint's: what joints
  /// lose to passive damping is in the torque that overcomes it. Power that a joint feeds back counts as
  /// well.
  double work = 0;
  double torque_squares = 0;  ///< of squared torques of the servo joints (servo minus damping), N^2 m^2 s
  double slip_squares = 0;    ///< of squared slip speeds of feet that touch, m^2/s

  friend MotionIntegrals operator-(const MotionIntegrals& a, const MotionIntegrals& b) noexcept {
    return {a.seconds - b.seconds, a.work - b.work, a.torque_squares - b.torque_squares,
            a.slip_squares - b.slip_squares};
  }
};

/// Collects a MotionSummary: contacts, torques and work at every physics step, loops every 10 ms, all else at
/// every control step. A value: copying one copies what it has seen. Adding to it allocates nothing.
class MotionStatistics {
 public:
  /// Knows the robot; sees nothing yet.
  explicit MotionStatistics(const RobotDescription& robot, const OutcomeLimits& limits = {});

  /// Begins the motion now. @param standing_height  of the base over the ground where it was put down, m
  void begin(const PhysicsBackend& world, double standing_height) noexcept;
  /// Is called after every physics step of a control step with these targets.
  void add_physics_step(const PhysicsBackend& world, const ControlTargets& targets) noexcept;
  /// Is called after every control step of `dt` seconds, the same for all steps of a motion.
  void add_control_step(const PhysicsBackend& world, const ControlTargets& targets, double dt) noexcept;
  /// Takes note that the robot was put elsewhere by hand: that way and turn are none of the motion's.
  void moved(const PhysicsBackend& world) noexcept;
  void note(Outcome outcome) noexcept;

  /// Tells whether an outcome has come about, of those that are known at once.
  bool has(Outcome outcome) const noexcept {
    return t_.first_at_s[static_cast<std::size_t>(outcome)].has_value();
  }
  /// Returns the worst of them, or kWalked.
  Outcome worst() const noexcept;
  /// Tells whether any of `terminations` has come about.
  bool any(const OutcomeSet& terminations) const noexcept;
  /// Returns roll, pitch, and yaw since the beginning, after the last control step, rad.
  const Vector3& roll_pitch_yaw() const noexcept { return t_.roll_pitch_yaw; }
  /// Returns where the robot faced when the motion began.
  const Heading& start_heading() const noexcept { return t_.start_heading; }
  /// Returns the height of the base over the ground when the motion began, settled, m.
  double begin_height() const noexcept { return t_.begin_height; }
  double weight() const noexcept { return t_.weight; }  ///< of the robot, N
  const Vector3& start() const noexcept { return t_.start; }
  /// Returns the height of the base over the ground below it after the last control step, m.
  double height() const noexcept { return t_.height; }
  /// Returns the integrals since the motion began.
  const MotionIntegrals& integrals() const noexcept { return t_.integrals; }

  MotionSummary summary(const PhysicsBackend& world) const;

 private:
  void add_torques(const PhysicsBackend& world, double h) noexcept;
  void add_attitude(const PhysicsBackend& world) noexcept;
  void see_attitude(const RobotState& state) noexcept;
  void add_path(const PhysicsBackend& world, double dt) noexcept;
  void add_command(const PhysicsBackend& world, const ControlTargets& targets, double last_yaw,
                   double dt) noexcept;
  void find_outcomes(const PhysicsBackend& world, double dt) noexcept;
  double hip_height(const PhysicsBackend& world) const noexcept;
  bool slid(double path) const noexcept;
  Outcome of_path() const noexcept;
  Outcome of_turn() const noexcept;

  OutcomeLimits limits_;
  std::vector<int> servos_;
  JointVector qd_;                             // of joints, before the next physics step
  std::shared_ptr<const LoopGaps> loop_gaps_;  // the same for all copies
  Vector3 hip_middle_;                         // in the base's frame
  double leg_length_, mass_;

  /// Counts physics steps of planned swing, and those of them in which the foot carried load.
  struct Swing {
    std::int64_t steps = 0, loaded = 0;
  };
  static std::optional<double> loaded_fraction(const LegArray<Swing>& legs) noexcept;

  /// Holds all that changes as the motion goes on. SI units and radians; distances are along the ground.
  struct Totals {
    // Set when the motion begins.
    double weight = 0;               ///< of the robot
    double standing_hip_height = 0;  ///< of the hips' middle over the ground where it was put down
    double begin_height = 0;         ///< of the base over the ground, settled
    double start_yaw = 0;
    Heading start_heading;
    Vector3 start = Vector3::Zero();  ///< of the base

    // As of the last control step.
    Vector3 roll_pitch_yaw = Vector3::Zero();  ///< yaw since the beginning
    double height = 0;                         ///< of the base over the ground below it
    double body_load = 0;                      ///< normal force on all but the feet, smoothed

    double time = 0;
    std::int64_t physics_steps = 0, control_steps = 0;
    std::int64_t steps_since_gap = 0;  ///< control steps since the loops were looked at
    std::int64_t steps_collapsed = 0;  ///< control steps without a break in which it lay low or on its body

    // The path of the base: straight pieces, and the one that has begun.
    double path = 0;                        ///< of the pieces that are finished
    Vector3 piece_start = Vector3::Zero();  ///< where the base was when the present piece began
    std::int64_t steps_in_piece = 0;        ///< control steps of the present piece

    double roll_squares = 0, pitch_squares = 0;  ///< sums over control steps
    std::int64_t ik_clamped = 0;
    double limit_factor = 1, max_penetration = 0, max_loop_gap = 0;

    MotionIntegrals integrals;

    // Integrals over time, of all feet together.
    double slip = 0;         ///< of speed of sliding, loaded feet
    double stance_slip = 0;  ///< the same of feet that were not to swing
    double stance_path = 0;  ///< of the speed of the base, once for every such foot

    // What the velocity command asked for, and what came of it.
    Heading course;  ///< that the command is meant in: where it faced when last a turn was asked for
    Vector3 last_position = Vector3::Zero();       ///< of the base, before this control step
    double commanded_path = 0, achieved_path = 0;  ///< `achieved_` in the direction of the command
    double strayed_path = 0;                       ///< to the left of that
    double commanded_turn = 0, achieved_turn = 0;  ///< angles; `achieved_` in the sense of the command
    double commanded_yaw = 0;  ///< where the yaw rate leads, as far as the steps could follow
    double planned_sweep = 0;  ///< way that stance feet were to sweep, of all feet together
    std::optional<double> max_heading_error;

    LegArray<std::int64_t> contact_steps{};    ///< physics steps in which the foot touched
    LegArray<Swing> swings{}, inner_swings{};  ///< `inner_` without the ends of each swing
    std::array<std::optional<double>, kOutcomes> first_at_s;
  };
  Totals t_;
};

}  // namespace crossgait
