#include "physics/robot/servo_stability.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "physics/robot/actuator.h"
#include "physics/robot/multibody.h"

namespace crossgait {

std::optional<ServoLoop> stiffest_servo_loop(const RobotDescription& robot, double dt) {
  const Eigen::Index joints = robot.joint_count();
  RobotState state;
  state.q = robot.home;
  Eigen::MatrixXd inertia = mass_matrix(robot, state);
  Eigen::VectorXd loop(joints);
  for (Eigen::Index i = 0; i < joints; ++i) {
    const Joint& joint = robot.joint(static_cast<int>(i));
    const double kp = joint.stiffness + (joint.actuated ? joint.kp : 0);
    const double kd = joint.damping + (joint.actuated ? joint.kd : 0);
    loop[i] = kd * dt + kp * dt * dt / 2;
    inertia(6 + i, 6 + i) += step_armature(joint, dt) - joint.armature;
    if (!is_implicit(joint)) continue;
    inertia(6 + i, 6 + i) += servo_inertia(joint, dt);
    loop[i] += joint.implicit_stiffness * joint.kp * dt * dt;
  }
  const Eigen::LLT<Eigen::MatrixXd> M(inertia);
  if (joints == 0 || !(loop.maxCoeff() > 0)) return std::nullopt;
  // M^-1 L has the eigenvalues of the symmetric L^1/2 M^-1 L^1/2.
  const Eigen::VectorXd root = loop.cwiseSqrt();
  const Eigen::MatrixXd inverse =
      M.solve(Eigen::MatrixXd::Identity(6 + joints, 6 + joints)).bottomRightCorner(joints, joints);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(root.asDiagonal() * inverse * root.asDiagonal());
  ServoLoop result;
  Eigen::Index worst = 0;
  modes.eigenvectors().col(joints - 1).cwiseAbs().maxCoeff(&worst);
  result.joint = static_cast<int>(worst);
  result.ratio = modes.eigenvalues()[joints - 1];
  result.inertia = loop[worst] / result.ratio;
  return result;
}

}  // namespace crossgait
