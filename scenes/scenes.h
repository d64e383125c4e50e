// Motions that every engine is put through, shared by tests and benchmarks.
#pragma once

#include <random>

#include "ik/leg_kinematics.h"
#include "physics/engine/physics_backend.h"
#include "scenes/robots.h"

namespace crossgait::scenes {

/// Describes a world of `robot`, everything else by default.
WorldSpec world_of(RobotPtr robot);

/// Returns targets that hold the home pose.
JointTargets home_targets(const RobotDescription& robot);

/// Draws every joint anywhere within its limits or a radian of home (whichever is nearer), any attitude, some
/// speed: no pose that a machine would take, but one that equations of motion must hold in. Loops are not
/// closed.
RobotState random_state(const RobotDescription& robot, std::mt19937& random);

/// Compares states bit for bit.
bool identical(const RobotState& a, const RobotState& b);

/// Computes a trot in closed form, feet commanded through the robot's inverse kinematics: it stands for
/// `kStand`, then diagonal pairs (FL, RR first) swing in turn, strides growing over the first cycle. Kept
/// apart from gait/, so that what is measured of engines does not move when a gait changes.
class Trot {
 public:
  static constexpr double kStand = 0.5;         ///< s
  static constexpr double kCycle = 0.8;         ///< s
  static constexpr double kStepLength = 0.045;  ///< m
  static constexpr double kStepHeight = 0.015;  ///< m

  explicit Trot(const RobotDescription& robot);
  JointTargets targets(double time) const noexcept;
  /// Returns true for a leg that is commanded into the air at `time`.
  static bool swings(Leg leg, double time) noexcept;

 private:
  LegArray<LegKinematics> legs_;
  LegArray<Vector3> rest_;  ///< foot in the leg frame at home
};

/// Moves every foot on its own circle and every tilt, for a robot that hangs in the air.
class Swing {
 public:
  explicit Swing(const RobotDescription& robot);
  JointTargets targets(double time) const noexcept;

 private:
  LegArray<LegKinematics> legs_;
  LegArray<Vector3> rest_;
};

}  // namespace crossgait::scenes
