// Loop closures as constraints of PhysX.
#pragma once

#include "backends/physx/link_constraint.h"
#include "physics/core/math.h"

namespace crossgait::physx {

/// Holds a point of one link at a point of another: three rows without bounds, solved along with contacts.
class LoopConstraint final : public LinkConstraint {
 public:
  /// @param p_A,p_B  the point in the links' frames of their centres of mass, m
  LoopConstraint(px::PxPhysics& physics, px::PxArticulationLink& a, const Vector3& p_A,
                 px::PxArticulationLink& b, const Vector3& p_B);

 private:
  struct Points {
    px::PxVec3 a, b;
  };

  static Prepare prepare;

  Points points_;
};

}  // namespace crossgait::physx
