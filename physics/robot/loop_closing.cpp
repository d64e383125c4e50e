#include "physics/robot/loop_closing.h"

#include <Eigen/QR>

#include "physics/robot/multibody.h"

namespace crossgait {
namespace {

/// Adds d(point)/d(passive joint angles), times `sign`, to three rows. The point is given in W, fixed to
/// `body`.
void add_point_jacobian(const RobotDescription& robot, const std::vector<Pose>& poses, int body,
                        const Vector3& p_WP, double sign, Eigen::Ref<Eigen::MatrixXd> rows) {
  for (int i = body; i > 0; i = robot.bodies[static_cast<std::size_t>(i)].parent) {
    const Joint& joint = robot.joint(i - 1);
    if (joint.actuated) continue;
    const Pose& X_WB = poses[static_cast<std::size_t>(i)];
    const Vector3 axis = X_WB.linear() * joint.axis;
    rows.col(i - 1) += sign * axis.cross(p_WP - X_WB.translation());
  }
}

}  // namespace

void close_loops(const RobotDescription& robot, JointVector& q) {
  constexpr int kIterations = 20;  // convergence is quadratic: about five are enough from a tenth of a radian
  const auto rows = static_cast<Eigen::Index>(3 * robot.loops.size() + robot.couplings.size());
  Eigen::VectorXd gaps(rows);
  Eigen::MatrixXd jacobian(rows, robot.joint_count());
  RobotState state;
  std::vector<Pose> poses;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    state.q = q;
    forward_kinematics(robot, state, poses);
    jacobian.setZero();
    Eigen::Index row = 0;
    for (const LoopClosure& loop : robot.loops) {
      const Vector3 p_WA = poses[static_cast<std::size_t>(loop.body_a)] * loop.p_AP;
      const Vector3 p_WB = poses[static_cast<std::size_t>(loop.body_b)] * loop.p_BP;
      gaps.segment<3>(row) = p_WA - p_WB;
      add_point_jacobian(robot, poses, loop.body_a, p_WA, 1, jacobian.middleRows<3>(row));
      add_point_jacobian(robot, poses, loop.body_b, p_WB, -1, jacobian.middleRows<3>(row));
      row += 3;
    }
    for (const JointCoupling& coupling : robot.couplings) {
      // Between two servos there is nothing to be moved.
      gaps[row] = q[coupling.follower] - coupling.follower_at(q[coupling.leader]);
      if (!robot.joint(coupling.follower).actuated) jacobian(row, coupling.follower) = 1;
      if (!robot.joint(coupling.leader).actuated)
        jacobian(row, coupling.leader) = -coupling.slope_at(q[coupling.leader]);
      ++row;
    }
    q -= jacobian.completeOrthogonalDecomposition().solve(gaps);
  }
}

}  // namespace crossgait
