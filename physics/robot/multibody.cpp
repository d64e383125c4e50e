#include "physics/robot/multibody.h"

#include <algorithm>

#include <Eigen/Cholesky>

namespace crossgait {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Inertia in world axes about the point O: maps the twist (v_O, w) to momentum and angular momentum about O.
Matrix6 spatial_inertia(const SpatialInertia& inertia, const Pose& X_WB, const Vector3& p_WO) {
  const Matrix3 R = X_WB.linear();
  const Matrix3 c = cross_matrix(X_WB * inertia.p_BC - p_WO);
  Matrix6 result;
  result << inertia.mass * Matrix3::Identity(), -inertia.mass * c, inertia.mass * c,
      R * inertia.I_C * R.transpose() - inertia.mass * c * c;
  return result;
}

/// Twist (v_O, w) that unit velocity of the body's joint gives to the body, in world axes at the point O.
Vector6 motion_subspace(const Body& body, const Pose& X_WB, const Vector3& p_WO) {
  const Vector3 axis = X_WB.linear() * body.joint.axis;
  Vector6 result;
  result << axis.cross(p_WO - X_WB.translation()), axis;
  return result;
}

RobotState at_zero_angles(const RobotDescription& robot) {
  RobotState state;
  state.q = JointVector::Zero(robot.joint_count());
  return state;
}

// Of what can move: a fixed base takes its six velocities out.
Eigen::MatrixXd moving_mass_matrix(const RobotDescription& robot, const RobotState& state, bool fixed_base) {
  const Eigen::Index size = robot.joint_count() + (fixed_base ? 0 : 6);
  return mass_matrix(robot, state).bottomRightCorner(size, size);
}

}  // namespace

void forward_kinematics(const RobotDescription& robot, const RobotState& state, std::vector<Pose>& poses) {
  poses.resize(robot.bodies.size());
  poses[0] = state.X_WB();
  for (std::size_t i = 1; i < robot.bodies.size(); ++i) {
    const Body& body = robot.bodies[i];
    const double angle = state.q[static_cast<Eigen::Index>(i) - 1];
    poses[i] =
        poses[static_cast<std::size_t>(body.parent)] * body.X_PB * Eigen::AngleAxisd(angle, body.joint.axis);
  }
}

std::vector<Pose> home_poses(const RobotDescription& robot) {
  RobotState state;
  state.q = robot.home;
  std::vector<Pose> poses;
  forward_kinematics(robot, state, poses);
  return poses;
}

void forward_velocities(const RobotDescription& robot, const RobotState& state,
                        const std::vector<Pose>& poses, std::vector<BodyVelocity>& velocities) {
  velocities.resize(robot.bodies.size());
  velocities[0] = {state.v_WB, state.w_WB};
  for (std::size_t i = 1; i < robot.bodies.size(); ++i) {
    const Body& body = robot.bodies[i];
    const auto parent = static_cast<std::size_t>(body.parent);
    const BodyVelocity& of_parent = velocities[parent];
    const Vector3 way = poses[i].translation() - poses[parent].translation();
    velocities[i].v = of_parent.v + of_parent.w.cross(way);
    velocities[i].w =
        of_parent.w + poses[i].linear() * body.joint.axis * state.qd[static_cast<Eigen::Index>(i) - 1];
  }
}

Eigen::MatrixXd point_jacobian(const RobotDescription& robot, const std::vector<Pose>& poses, int body,
                               const Vector3& p_BP) {
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  const Vector3 p_WP = poses[at(body)] * p_BP;
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, 6 + robot.joint_count());
  J.topLeftCorner<6, 6>().setIdentity();
  J.block<3, 3>(0, 3) = -cross_matrix(p_WP - poses[0].translation());
  for (int i = body; i > 0; i = robot.bodies[at(i)].parent)
    J.col(6 + i - 1) = motion_subspace(robot.bodies[at(i)], poses[at(i)], p_WP);
  return J;
}

Eigen::MatrixXd mass_matrix(const RobotDescription& robot, const RobotState& state) {
  std::vector<Pose> poses;
  forward_kinematics(robot, state, poses);
  const Vector3 p_WO = poses[0].translation();

  // All quantities are in world axes about the base origin, so that neither composite inertias nor forces
  // need a transformation between bodies.
  std::vector<Matrix6> composite;
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    composite.push_back(spatial_inertia(robot.bodies[i].inertia, poses[i], p_WO));
  }
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(6 + robot.joint_count(), 6 + robot.joint_count());
  for (std::size_t i = robot.bodies.size() - 1; i > 0; --i) {
    const Body& body = robot.bodies[i];
    composite[static_cast<std::size_t>(body.parent)] += composite[i];
    const Vector6 force = composite[i] * motion_subspace(body, poses[i], p_WO);
    const auto row = static_cast<Eigen::Index>(6 + i - 1);
    M.block<1, 6>(row, 0) = force.transpose();
    for (std::size_t j = i; j > 0; j = static_cast<std::size_t>(robot.bodies[j].parent)) {
      M(row, static_cast<Eigen::Index>(6 + j - 1)) =
          motion_subspace(robot.bodies[j], poses[j], p_WO).dot(force);
    }
    M(row, row) += body.joint.armature;
  }
  M.topLeftCorner<6, 6>() = composite[0];
  return M.selfadjointView<Eigen::Lower>();
}

double max_loop_gap(const RobotDescription& robot, const std::vector<Pose>& poses) noexcept {
  double gap = 0;
  for (const LoopClosure& loop : robot.loops) {
    const Vector3 p_WA = poses[static_cast<std::size_t>(loop.body_a)] * loop.p_AP;
    const Vector3 p_WB = poses[static_cast<std::size_t>(loop.body_b)] * loop.p_BP;
    gap = std::max(gap, (p_WA - p_WB).norm());
  }
  return gap;
}

Vector3 foot_position(const RobotDescription& robot, Leg leg, const std::vector<Pose>& poses) {
  const LegModel& model = robot.legs.value()[leg];
  return poses[static_cast<std::size_t>(model.foot_body)] * model.p_BF;
}

std::vector<double> translational_inverse_weights(const RobotDescription& robot, bool fixed_base) {
  const RobotState state = at_zero_angles(robot);
  std::vector<Pose> poses;
  forward_kinematics(robot, state, poses);

  const Eigen::LLT<Eigen::MatrixXd> M(moving_mass_matrix(robot, state, fixed_base));
  const Eigen::Index size = M.rows();
  std::vector<double> weights;
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    const Eigen::MatrixXd J = point_jacobian(robot, poses, static_cast<int>(i), robot.bodies[i].inertia.p_BC)
                                  .topRightCorner(3, size);
    weights.push_back(size == 0 ? 0 : (J * M.solve(J.transpose())).trace() / 3);
  }
  return weights;
}

JointVector joint_inverse_weights(const RobotDescription& robot, bool fixed_base) {
  const Eigen::LLT<Eigen::MatrixXd> M(moving_mass_matrix(robot, at_zero_angles(robot), fixed_base));
  return M.solve(Eigen::MatrixXd::Identity(M.rows(), M.rows())).diagonal().tail(robot.joint_count());
}

}  // namespace crossgait
