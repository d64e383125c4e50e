// Equations of motion of a tree of rigid bodies: M(q) v' + bias(q, v) = forces.
#pragma once

#include <vector>

#include <Eigen/Cholesky>

#include "crossgait/physics/robot/robot.h"
#include "crossgait/physics/robot/state.h"

namespace crossgait::skeleton {

// Velocities are [v_WC, w_WB, qd], in world axes; C is the base's centre of mass, so that a body in the air
// moves on a parabola to rounding. All storage is inline: a step allocates nothing.
inline constexpr int kMaxDofs = 6 + kMaxJoints;
using DofVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxDofs, 1>;
using DofMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxDofs, kMaxDofs>;
using PointJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxDofs>;

class Dynamics {
 public:
  /// @param robot  has to outlive it
  /// @param physics_dt  s, by which dampers that act on the speed at a step's end count (step_armature)
  Dynamics(const RobotDescription& robot, double physics_dt);

  /// Computes every quantity below for a state. @param gravity  m/s^2
  void update(const RobotState& state, const Vector3& gravity) noexcept;

  const Pose& pose(int body) const { return links_[static_cast<std::size_t>(body)].X_WB; }
  const Vector3& base_centre() const { return links_[0].centre; }  ///< in W, m
  const DofVector& velocity() const { return velocity_; }
  /// Returns the mass matrix, armature included; kg, kg m, kg m^2.
  const DofMatrix& mass_matrix() const { return M_; }
  /// Returns forces that keep v' at zero, gravity included; N, N m.
  const DofVector& bias() const { return bias_; }
  /// Returns the Jacobian of the velocity of a body's point at p_WP, rows in W.
  PointJacobian jacobian(int body, const Vector3& p_WP) const noexcept;

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  struct Link {
    Pose X_WB;
    Vector3 centre, axis;   // centre of mass, m; unit axis of its joint; in W
    Matrix3 inertia;        // about the centre of mass, in W's axes
    Vector3 point;          // that its acceleration is known of: its joint, or the base's centre of mass
    Vector3 w, alpha, a;    // turning, and how the point accelerates, if v' = 0
    Vector3 force, moment;  // of what hangs on its joint, itself included; moment about C
    Matrix6 composite;      // spatial inertia of the same, about C
  };

  void place(const RobotState& state) noexcept;
  void compute_mass_matrix() noexcept;
  void compute_bias(const Vector3& gravity) noexcept;
  std::size_t parent(std::size_t i) const { return static_cast<std::size_t>(robot_.bodies[i].parent); }
  static Eigen::Index dof(std::size_t body) { return static_cast<Eigen::Index>(body) + 5; }
  Vector6 motion(const Link& link) const;

  const RobotDescription& robot_;
  double physics_dt_;
  std::vector<Link> links_;
  DofVector velocity_, bias_;
  DofMatrix M_;
};

}  // namespace crossgait::skeleton
