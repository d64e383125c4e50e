// What to simulate, before any engine is chosen.
#pragma once

#include <memory>

#include "physics/robot/robot.h"
#include "physics/terrain/terrain.h"

namespace crossgait {

class WorldGroup;

/// Physics steps, s. A thousandth of the usual one is far beyond where the engines' results stop changing.
inline constexpr double kShortestPhysicsStep = 1e-6, kLongestPhysicsStep = 0.1;

/// Holds the effort of the iterative parts of an engine's solver.
struct SolverSpec {
  double tolerance = 1e-8;  ///< MuJoCo Newton and the matched cone solve stop here
  int iterations = 100;     ///< at most (MuJoCo's Newton, Bullet's projected Gauss-Seidel sweeps)
};

struct WorldSpec {
  std::shared_ptr<const RobotDescription> robot;
  Terrain terrain;
  double physics_dt = 1e-3;             ///< s
  Vector3 gravity = {0, 0, -kGravity};  ///< m/s^2
  bool fixed_base = false;              ///< weld the base to the world where reset puts it
  ContactSpec contact;
  SolverSpec solver;
  std::shared_ptr<WorldGroup> group = {};  ///< that a world is made for; PhysicsBackend::spec() has none

  /// Makes the time constants of contact and of the robot's soft joints and loops those that the law has in
  /// steps of `dt` (s; time_constant_in_steps): what is simulated in such steps, and still is in shorter
  /// ones. The robot is copied where any of its own changes.
  void lengthen_time_constants(double dt);

  /// @throws ConfigError naming the field
  void validate() const;
};

}  // namespace crossgait
