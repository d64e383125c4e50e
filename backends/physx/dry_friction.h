// Dry friction of a joint beside PhysX's own drive, which an implicit servo needs for itself.
#pragma once

#include "backends/physx/link_constraint.h"
#include "physics/core/math.h"

namespace crossgait::physx {

/// Stops a joint as far as a torque lets it: one row without a target of its own, bounded both ways.
class DryFriction final : public LinkConstraint {
 public:
  /// @param axis  of the joint, in the parent link's frame of its centre of mass
  /// @param torque  at most, N m
  DryFriction(px::PxPhysics& physics, px::PxArticulationLink& parent, px::PxArticulationLink& child,
              const Vector3& axis, double torque);

  double torque() const noexcept { return row_.torque; }  ///< N m

 private:
  struct Row {
    px::PxVec3 axis;
    float torque;
  };

  static Prepare prepare;

  Row row_;
};

}  // namespace crossgait::physx
