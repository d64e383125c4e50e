// The joint-space inertia of a btMultiBody, and how its points move.
#pragma once

#include <array>

#include <BulletDynamics/Featherstone/btMultiBody.h>

#include "backends/contact/joint_space_inertia.h"

namespace crossgait::bullet {

using contact::DofVector;
using contact::PointJacobian;

/// Computes M0 by the composite-rigid-body algorithm in world axes about the base's centre of mass
/// (Featherstone 2008, section 6.2), for degrees of freedom in Bullet's order [w_W, v_W of the base's centre
/// of mass, joint velocities]. Bullet itself offers the inverse of M0 alone, one column per 0.8 us tree
/// traversal; every constraint row needs the inverse *with* armature. Tests hold M0 against the inverse that
/// Bullet's articulated-body algorithm gives.
class CompositeInertia {
 public:
  explicit CompositeInertia(const btMultiBody& body);

  /// Reads the world transforms that Bullet cached for the current configuration, fills M0 and factors it.
  void update(contact::JointSpaceInertia& inertia) noexcept;

  /// Finds the velocity of the point p_WP of link `link` (-1: base) per unit of each dof, W. After `update`.
  void point_jacobian(int link, const Vector3& p_WP, PointJacobian& J) const noexcept;

 private:
  struct Composite {  // spatial inertia about the reference point, world axes
    double mass;
    Vector3 moment;  // mass times centre of mass
    Matrix3 inertia;
  };
  void accumulate_composites() noexcept;
  void fill(contact::JointSpaceInertia& M) const noexcept;

  const btMultiBody& body_;
  std::array<int, kMaxJoints> parent_link_{};
  Vector3 reference_ = Vector3::Zero();              // base centre of mass, W
  std::array<Vector3, kMaxJoints> axis_w_, axis_v_;  // joint motion: angular, and linear at the reference
  std::array<Composite, kMaxJoints + 1> composite_;  // base first
};

}  // namespace crossgait::bullet
