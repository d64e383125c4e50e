// DART's Skeleton of a RobotDescription, in Crossgait's degrees of freedom.
#pragma once

#include <vector>

#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/WeldJoint.hpp>

#include "backends/contact/tree_dynamics.h"
#include "physics/engine/world_spec.h"
#include "physics/robot/state.h"

namespace crossgait::dart {

/// Keeps where the base is. DART keeps positions of a free joint as a logarithm and takes it back with an
/// error of the third order near the identity (1e-9 m in a trot): the pose is kept beside it instead.
class BaseJoint final : public ::dart::dynamics::FreeJoint {
 public:
  explicit BaseJoint(const Properties& properties) : FreeJoint(properties) {}

  /// Sets the pose of the base's centre of mass, in the base's axes.
  void place(const Pose& X_WC);

 protected:
  Joint* clone() const override;
  void updateRelativeTransform() const override { mT = X_WC_; }

 private:
  Pose X_WC_ = Pose::Identity();
};

/// Leaves configuration and velocities to the caller: DART integrates nothing. Its own are forces of gravity
/// and motion (recursive Newton-Euler), inertias, Jacobians and poses; M0 is the sum of J' I J over its
/// bodies. Forward dynamics by articulated bodies would take half of a step, and be multiplied by M0 again.
///
/// DART's free joint has its velocities in the axes of the base, which turn.
class SkeletonModel final : public contact::TreeDynamics {
 public:
  explicit SkeletonModel(const WorldSpec& spec);

  void place(const Pose& X_WC, const JointVector& q, const contact::DofVector& v) noexcept override;
  void free_impulse(double h, const Wrench& base, const contact::JointSpaceInertia& inertia,
                    const contact::DofVector& v, contact::DofVector& p) noexcept override;
  void bare_inertia(contact::JointSpaceInertia& inertia) noexcept override;
  void point_jacobian(int body, const Vector3& p_WP, contact::PointJacobian& J) const noexcept override;

  const std::vector<Pose>& X_BC() const noexcept override { return X_BC_; }
  const Pose& X_WC(int body) const noexcept override { return node(body).getWorldTransform(); }
  SpatialInertia inertia(int body) const override;

 private:
  const ::dart::dynamics::BodyNode& node(int body) const { return *nodes_[static_cast<std::size_t>(body)]; }
  void add_body(const RobotDescription& robot, std::size_t i, bool fixed_base);

  ::dart::dynamics::SkeletonPtr skeleton_;
  BaseJoint* base_ = nullptr;                       ///< of a free base
  ::dart::dynamics::WeldJoint* weld_ = nullptr;     ///< of a fixed one
  std::vector<::dart::dynamics::BodyNode*> nodes_;  ///< by body
  std::vector<std::vector<int>> dofs_;              ///< by body: ours, of the columns of DART's Jacobian
  std::vector<Pose> X_BC_;
  Matrix3 R_WB_ = Matrix3::Identity();
  Eigen::VectorXd positions_, velocities_;  ///< DART's
  int first_ = 0;                           ///< dof that can move
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, contact::kMaxDofs> jacobian_, momentum_;
};

}  // namespace crossgait::dart
