#include "backends/dart/skeleton_model.h"

#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/WeldJoint.hpp>

namespace crossgait::dart {
namespace {

namespace dd = ::dart::dynamics;

}  // namespace

void BaseJoint::place(const Pose& X_WC) {
  X_WC_ = X_WC;
  notifyPositionUpdated();
}

dd::Joint* BaseJoint::clone() const {
  auto* joint = new BaseJoint(getFreeJointProperties());
  joint->X_WC_ = X_WC_;
  return joint;
}

SkeletonModel::SkeletonModel(const WorldSpec& spec)
    : skeleton_(dd::Skeleton::create("robot")), first_(spec.fixed_base ? 6 : 0) {
  const RobotDescription& robot = *spec.robot;
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    X_BC_.push_back(Pose::Identity());
    if (i == 0) X_BC_[0].translation() = robot.bodies[0].inertia.p_BC;
    add_body(robot, i, spec.fixed_base);
  }
  skeleton_->setGravity(spec.gravity);
  skeleton_->disableSelfCollisionCheck();
  for (const dd::BodyNode* body : nodes_) {
    std::vector<int>& dofs = dofs_.emplace_back();
    for (const std::size_t k : body->getDependentGenCoordIndices())
      dofs.push_back(static_cast<int>(k) + first_);
  }
  positions_.setZero(static_cast<Eigen::Index>(skeleton_->getNumDofs()));
  velocities_ = positions_;
}

void SkeletonModel::add_body(const RobotDescription& robot, std::size_t i, bool fixed_base) {
  const Body& body = robot.bodies[i];
  dd::BodyNode::Properties own;
  own.mName = body.name;
  own.mInertia = dd::Inertia(body.inertia.mass, X_BC_[i].inverse() * body.inertia.p_BC, body.inertia.I_C);
  if (i > 0) {
    const auto parent = static_cast<std::size_t>(body.parent);
    dd::RevoluteJoint::Properties joint;
    joint.mName = body.joint.name;
    joint.mAxis = body.joint.axis;
    joint.mT_ParentBodyToJoint = X_BC_[parent].inverse() * body.X_PB;
    nodes_.push_back(
        skeleton_->createJointAndBodyNodePair<dd::RevoluteJoint>(nodes_[parent], joint, own).second);
  } else if (fixed_base) {
    const auto pair =
        skeleton_->createJointAndBodyNodePair<dd::WeldJoint>(nullptr, dd::WeldJoint::Properties(), own);
    weld_ = pair.first;
    nodes_.push_back(pair.second);
  } else {
    const auto pair = skeleton_->createJointAndBodyNodePair<BaseJoint>(nullptr, BaseJoint::Properties(), own);
    base_ = pair.first;
    nodes_.push_back(pair.second);
  }
}

void SkeletonModel::place(const Pose& X_WC, const JointVector& q, const contact::DofVector& v) noexcept {
  R_WB_ = X_WC.linear();
  if (base_ != nullptr) {
    base_->place(X_WC);
    velocities_.head<3>() = R_WB_.transpose() * v.head<3>();
    velocities_.segment<3>(3) = R_WB_.transpose() * v.segment<3>(3);
  } else {
    weld_->setTransformFromParentBodyNode(X_WC);
  }
  positions_.tail(q.size()) = q;
  velocities_.tail(q.size()) = v.tail(q.size());
  skeleton_->setPositions(positions_);
  skeleton_->setVelocities(velocities_);
}

// By the forces that accelerations of zero would take. In the base's axes, which turn by w, those are of the
// velocity u of its centre of mass a change of w x u in W.
void SkeletonModel::free_impulse(double h, const Wrench& base, const contact::JointSpaceInertia& inertia,
                                 const contact::DofVector& v, contact::DofVector& p) noexcept {
  const Eigen::VectorXd& bias = skeleton_->getCoriolisAndGravityForces();
  const Eigen::Index joints = v.size() - 6;
  p.setZero(v.size());
  if (base_ != nullptr) {
    contact::DofVector turn = contact::DofVector::Zero(v.size());
    turn.segment<3>(3) = h * Vector3(v.head<3>()).cross(Vector3(v.segment<3>(3)));
    inertia.multiply_bare(turn, p);
    p.head<3>() += h * (base.torque - R_WB_ * bias.head<3>());
    p.segment<3>(3) += h * (base.force - R_WB_ * bias.segment<3>(3));
  }
  p.tail(joints) -= h * bias.tail(joints);
}

void SkeletonModel::bare_inertia(contact::JointSpaceInertia& inertia) noexcept {
  for (int row = first_; row < inertia.dofs(); ++row) {
    for (int column = first_; column <= row; ++column) inertia.bare(row, column) = 0;
  }
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const auto& J = nodes_[i]->getJacobian();  // of C, in its axes: angular, then linear
    const std::vector<int>& dofs = dofs_[i];
    jacobian_ = J;
    if (base_ != nullptr) {
      jacobian_.leftCols<3>() = J.leftCols<3>() * R_WB_.transpose();
      jacobian_.middleCols<3>(3) = J.middleCols<3>(3) * R_WB_.transpose();
    }
    momentum_.noalias() = nodes_[i]->getSpatialInertia() * jacobian_;
    for (std::size_t r = 0; r < dofs.size(); ++r) {
      for (std::size_t c = 0; c <= r; ++c) {
        inertia.bare(dofs[r], dofs[c]) +=
            jacobian_.col(static_cast<Eigen::Index>(r)).dot(momentum_.col(static_cast<Eigen::Index>(c)));
      }
    }
  }
  inertia.factor();
}

void SkeletonModel::point_jacobian(int body, const Vector3& p_WP, contact::PointJacobian& J) const noexcept {
  const auto i = static_cast<std::size_t>(body);
  const Pose& X = nodes_[i]->getWorldTransform();
  const Vector3 p_CP = X.linear().transpose() * (p_WP - X.translation());
  const auto& spatial = nodes_[i]->getJacobian();
  J.setZero(3, 6 + static_cast<Eigen::Index>(nodes_.size()) - 1);
  for (std::size_t k = 0; k < dofs_[i].size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const Vector3 w = spatial.col(column).head<3>(), v = spatial.col(column).tail<3>();
    J.col(dofs_[i][k]) = X.linear() * (v + w.cross(p_CP));
  }
  if (base_ != nullptr) {
    J.leftCols<3>() *= R_WB_.transpose();
    J.middleCols<3>(3) *= R_WB_.transpose();
  }
}

SpatialInertia SkeletonModel::inertia(int body) const {
  const dd::Inertia& held = node(body).getInertia();
  return {held.getMass(), X_BC_[static_cast<std::size_t>(body)] * held.getLocalCOM(), held.getMoment()};
}

}  // namespace crossgait::dart
