// The equations of motion of a step, with soft loops and the points that may touch: what an engine needs that
// is a law of contact and nothing else.
#pragma once

#include <vector>

#include "physics/engine/contact_features.h"
#include "physics/engine/soft_law.h"
#include "physics/engine/world_spec.h"
#include "physics/robot/multibody.h"

namespace crossgait {

/// Assembles M u' + bias = forces in the velocities u = [v_WC, w_WB, qd], C the base's centre of mass, so
/// that a body in the air moves on a parabola to rounding. Sources: Featherstone, Rigid Body Dynamics
/// Algorithms, 2008, sections 5.3 and 6.2; loops and couplings as MuJoCo's soft equalities (MuJoCo manual,
/// "Computation > Constraint model"), which nothing bounds, so that they go into the matrix.
class StepEquations {
 public:
  /// Is a point that touches, or may within the step.
  struct Point {
    int body = 0, leg = -1;
    Vector3 p_WP = Vector3::Zero(), normal = Vector3::UnitZ();  ///< m; unit, from terrain to robot
    double distance = 0;                                        ///< m, negative when penetrating
  };

  /// @param spec  has to outlive it
  /// @param margin  up to which points above the ground are listed, m
  StepEquations(const WorldSpec& spec, double margin);

  /// Computes every quantity below for a state.
  void update(const RobotState& state);

  const Eigen::MatrixXd& mass_matrix() const noexcept { return M_; }  ///< with armature; kg, kg m, kg m^2
  const Eigen::VectorXd& bias() const noexcept { return bias_; }      ///< gravity included; N, N m
  const Eigen::VectorXd& velocity() const noexcept { return u_; }
  /// Return what loops and couplings add to both sides of A u_next = b, where A is M and b is M u + h (forces
  /// - bias).
  const Eigen::MatrixXd& loop_matrix() const noexcept { return A_; }
  const Eigen::VectorXd& loop_vector() const noexcept { return b_; }
  const DeepestPoints<Point>& points() const noexcept { return points_; }
  /// Returns the Jacobian of the velocity of a body's point at p_WP, 3 x size of u, rows in W.
  Eigen::MatrixXd jacobian(int body, const Vector3& p_WP) const;

 private:
  /// A soft row, the same in all its directions.
  struct SoftRow {
    SoftLaw law;
    double inverse_weight;
  };
  Eigen::MatrixXd full_jacobian(int body, const Vector3& p_BP) const;
  void add_bodies(const RobotState& state);
  void add_loops(const JointVector& q);
  void add_soft_row(const SoftRow& row, const Eigen::MatrixXd& J, const Eigen::VectorXd& gap);
  void find_points();

  const WorldSpec& spec_;
  double margin_;
  std::vector<ContactFeature> features_;
  std::vector<SoftRow> of_loops_, of_couplings_;
  std::vector<Pose> poses_;
  std::vector<BodyVelocity> velocities_;
  Eigen::MatrixXd M_, A_;
  Eigen::VectorXd bias_, u_, b_;
  DeepestPoints<Point> points_;
};

}  // namespace crossgait
