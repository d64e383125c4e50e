// From foot targets to servo targets: inverse kinematics of four legs, and a count of what could not be
// reached.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "ik/leg_kinematics.h"
#include "motion/controller.h"
#include "motion/servo_compensation.h"
#include "physics/engine/world_spec.h"
#include "physics/robot/robot.h"
#include "physics/robot/state.h"
#include "physics/terrain/terrain.h"

namespace crossgait {

/// Returns what a mass weighs on level ground of `world`, N/kg: the part of its gravity that presses on it.
/// On an incline (gravity that is tilted) the rest pulls along the ground.
double weight_per_mass(const WorldSpec& world) noexcept;

/// Solves all four legs at once. Constructing one reads the geometry of the robot; updates allocate nothing.
class FootTargetTracker {
 public:
  /// @param gravity  what a mass weighs where the robot stands, N/kg (`weight_per_mass`)
  /// @throws ConfigError if the robot has no legs, or none that `make_leg_kinematics` knows
  explicit FootTargetTracker(std::shared_ptr<const RobotDescription> description,
                             const ServoCompensation& compensation = {}, double gravity = kGravity);

  /// @param feet targets in each leg's frame (x forward, y left, z up), m; of legs without abduction y counts
  ///             as 0, of those whose knee follows their hip x as what y and z leave it
  /// @param dt   time since the last update, s; velocities are differences over it
  /// @returns targets of the actuated joints
  const JointTargets& update(const LegArray<Vector3>& feet, double dt) noexcept;

  /// Sets the share of the load that standing legs make up for, of a gait's parameters; without one, that of
  /// the default parameters.
  void set_load_share(double share) noexcept { load_share_ = share; }

  /// Forgets the last update, so that the next one starts from rest, and the count of clamped solutions.
  void restart() noexcept;

  /// Stands the robot at rest with its feet where `feet` says (leg frames) and just clear of `terrain`.
  /// @throws ConfigError if a foot is out of reach
  RobotState standing_state(const LegArray<Vector3>& feet, const Terrain& terrain,
                            const Placement& placement) const;
  /// Stands the robot over the world's origin, facing +x.
  RobotState standing_state(const LegArray<Vector3>& feet, const Terrain& terrain) const {
    return standing_state(feet, terrain, Placement());
  }

  /// Returns what GaitGenerator::set_rolling_correction takes at standing feet (leg frames, m), legs' mean.
  /// Two things come between a sweep and the body's advance. While the centre of a spherical foot moves by
  /// dp, its link turns by w dp, and the foot rolls on by r w x z dp. And what the servos do not make up for
  /// of their load gives way by J K^-1 J' F, which differs from one end of the sweep to the other.
  /// @throws ConfigError if a foot is out of reach
  Vector2 rolling_correction(const LegArray<Vector3>& feet, const GaitParameters& parameters) const;

  const LegArray<LegKinematics>& kinematics() const noexcept { return kinematics_; }
  /// Returns the status of each leg in the last update.
  const LegArray<IkStatus>& status() const noexcept { return status_; }
  /// Counts leg solutions that were not kOk since construction or `restart`.
  std::int64_t clamped() const noexcept { return clamped_; }

 private:
  void set_joints(Leg leg, const Vector3& foot, JointVector& q) const;
  Vector3 compliance_deflection(Leg leg, const Vector3& foot, double load) const noexcept;

  struct LegServos {
    std::array<Eigen::Index, 3> slots{};  // of the leg's servos in JointTargets
    Eigen::Index count = 0;
    Vector3 stiffness = Vector3::Ones();  // N m/rad
    std::array<JointDrag, 3> drag;        // servo and joint together
    JointDrag passive_drag;
    std::array<JointLimits, 3> limits;  // those of what moves with a servo in them, rad
    bool is_on_surface = false;         // abduction and one servo more: the foot moves on a surface
  };
  struct LastUpdate {
    Vector3 position = Vector3::Zero();  // m
    Vector3 servos = Vector3::Zero();    // rad
  };
  // What a leg is to do, and what compensation takes of its kinematics. Of legs with fewer servos than three
  // the last entries stand for none: loops over sizes that the compiler knows are unrolled.
  struct Solution {
    IkStatus status = IkStatus::kOk;
    Vector3 servos = Vector3::Zero();    // rad
    Matrix3 jacobian = Matrix3::Zero();  // of nothing where nothing is compensated
    Vector3 drag = Vector3::Zero();      // of passive elbows on the foot, N
  };
  bool compensates() const noexcept { return compensation_.lag || compensation_.load; }
  Solution follow(Leg leg, const Vector3& foot, double dt) const noexcept;
  Vector3 torque(Leg leg, const Solution& at, double load, double dt) const noexcept;
  LegInverse solve(Leg leg, const Vector3& foot) const noexcept;

  std::shared_ptr<const RobotDescription> robot_;
  ServoCompensation compensation_;
  double load_share_ = GaitParameters{}.load_share;
  double weight_;        // of the robot where it stands, N
  bool moving_ = false;  // last_ holds an earlier update
  LegArray<LegKinematics> kinematics_;
  LegArray<LegServos> servos_{};
  LegArray<LastUpdate> last_{};
  LegArray<IkStatus> status_{};
  JointTargets targets_;
  std::int64_t clamped_ = 0;
};

/// Solves for feet (in the leg frames, m) after `dt` more seconds, and counts legs that could not follow.
void solve_legs(FootTargetTracker& legs, const LegArray<Vector3>& feet, double dt,
                ControlTargets& out) noexcept;

}  // namespace crossgait
