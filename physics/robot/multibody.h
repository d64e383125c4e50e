// Rigid-body algorithms on a RobotDescription, independent of any engine: a third opinion for tests, MuJoCo's
// inverse weights for the matched contact law, and loop gaps and foot positions for metrics.
#pragma once

#include <vector>

#include "physics/robot/robot.h"
#include "physics/robot/state.h"

namespace crossgait {

/// Computes poses X_WBody of all bodies. `poses` is resized to the body count (no allocation when it already
/// has that size).
void forward_kinematics(const RobotDescription& robot, const RobotState& state, std::vector<Pose>& poses);

/// Computes them in the home pose, the base's frame that of the world.
std::vector<Pose> home_poses(const RobotDescription& robot);

/// Holds the velocity of a body in W: of its origin (m/s), and angular (rad/s).
struct BodyVelocity {
  Vector3 v = Vector3::Zero(), w = Vector3::Zero();
};

/// Finds velocities of all bodies. @param poses  of the same state. `velocities` is resized as `poses` there.
void forward_velocities(const RobotDescription& robot, const RobotState& state,
                        const std::vector<Pose>& poses, std::vector<BodyVelocity>& velocities);

/// Computes the Jacobian of a point that is fixed in a body, 6 x (6 + joints): rows are the velocity of the
/// point and the body's angular velocity in W, columns [v_WB, w_WB, qd] as those of `mass_matrix`. Source:
/// Featherstone, Rigid Body Dynamics Algorithms, 2008, section 4.1.
/// @param p_BP  in the body's frame, m
Eigen::MatrixXd point_jacobian(const RobotDescription& robot, const std::vector<Pose>& poses, int body,
                               const Vector3& p_BP);

/// Computes joint-space inertia by the composite-rigid-body algorithm (Featherstone, Rigid Body Dynamics
/// Algorithms, 2008, section 6.2) in world axes, including armature. Rows and columns [v_WB, w_WB, qd], of
/// size 6 + joints.
Eigen::MatrixXd mass_matrix(const RobotDescription& robot, const RobotState& state);

/// Returns the largest distance between the two points of any loop closure, m.
double max_loop_gap(const RobotDescription& robot, const std::vector<Pose>& poses) noexcept;

/// Returns the centre of the foot sphere in W, m. Requires legs.
Vector3 foot_position(const RobotDescription& robot, Leg leg, const std::vector<Pose>& poses);

/// Computes the translational inverse weight of every body, 1/kg: the mean diagonal of J M^-1 J^T for the
/// velocity of its centre of mass at zero joint angles, armature included. MuJoCo's body_invweight0[0]
/// (mj_setConst), the scale of its soft constraints; zero where a body cannot move.
std::vector<double> translational_inverse_weights(const RobotDescription& robot, bool fixed_base);

/// Computes the inverse weight of every joint, 1/(kg m^2): the diagonal of M^-1 at zero joint angles,
/// armature included. MuJoCo's dof_invweight0 (mj_setConst), the scale of its dry friction in joints.
JointVector joint_inverse_weights(const RobotDescription& robot, bool fixed_base);

}  // namespace crossgait
