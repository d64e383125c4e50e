// A code for the dynamics of a tree of bodies, to which everything else of a step is added here.
#pragma once

#include <vector>

#include "backends/contact/body_kinematics.h"
#include "physics/engine/physics_backend.h"

namespace crossgait::contact {

/// Returns frame C of every body in its own, as TreeDynamics has them.
inline std::vector<Pose> tree_frames(const RobotDescription& robot) {
  std::vector<Pose> X_BC(robot.bodies.size(), Pose::Identity());
  X_BC[0].translation() = robot.bodies[0].inertia.p_BC;
  return X_BC;
}

/// Is asked for dynamics, inertia, Jacobians and poses of a robot; armature, joint torques, loops,
/// contacts and integration are TreeBackend's. Bodies are RobotDescription's, and frame C of a body has its
/// own axes: at its origin, but of the base at its centre of mass, since only about that do linear and
/// angular momentum decouple. Degrees of freedom are [w_W, v_W of the base's centre of mass, joint
/// velocities], in world axes, rad/s and m/s. Nothing here may throw nor allocate beside the engine's own
/// library, but for `renew`.
class TreeDynamics {
 public:
  TreeDynamics() = default;
  virtual ~TreeDynamics() = default;
  TreeDynamics(const TreeDynamics&) = delete;
  TreeDynamics& operator=(const TreeDynamics&) = delete;

  /// Makes good what a state that exploded has left, before a reset.
  virtual void renew() {}
  /// Takes a state: all that is asked below is in it. @param X_WC  of the base  @param v  velocities
  virtual void place(const Pose& X_WC, const JointVector& q, const DofVector& v) noexcept = 0;
  /// Computes M0, without armature, and has it factored.
  virtual void bare_inertia(JointSpaceInertia& inertia) noexcept = 0;
  /// Computes p = M0 (v' - v), v' being velocities after a step of `h` seconds of gravity, gyroscopic forces
  /// and a wrench on the base (its force at the centre of mass), without joint torques, armature, loops or
  /// contact.
  /// @param inertia  what `bare_inertia` made in this state  @param v  velocities in it
  virtual void free_impulse(double h, const Wrench& base, const JointSpaceInertia& inertia,
                            const DofVector& v, DofVector& p) noexcept = 0;
  /// Computes 3 x dofs: velocity in W of the point of `body` at p_WP per unit of each dof.
  virtual void point_jacobian(int body, const Vector3& p_WP, PointJacobian& J) const noexcept = 0;

  /// Returns frame C of every body in its own.
  virtual const std::vector<Pose>& X_BC() const noexcept = 0;
  /// Returns the pose of C.
  virtual const Pose& X_WC(int body) const noexcept = 0;
  /// Returns inertia as the engine holds it, in the body's own frame.
  virtual SpatialInertia inertia(int body) const = 0;
};

}  // namespace crossgait::contact
