#include "backends/physx/dry_friction.h"

#include "backends/physx/convert.h"

namespace crossgait::physx {

DryFriction::DryFriction(px::PxPhysics& physics, px::PxArticulationLink& parent,
                         px::PxArticulationLink& child, const Vector3& axis, double torque)
    : row_{vector(axis), static_cast<float>(torque)} {
  make(physics, parent, child, prepare, &row_, sizeof(Row), px::PxConstraintFlag::eDRIVE_LIMITS_ARE_FORCES);
}

px::PxU32 DryFriction::prepare(px::Px1DConstraint* rows, px::PxVec3p& offset, px::PxU32 /*most*/,
                               px::PxConstraintInvMassScale& scale, const void* data,
                               const px::PxTransform& A, const px::PxTransform& B, bool /*extended_limits*/,
                               px::PxVec3p& at_A, px::PxVec3p& at_B) {
  const auto& row = *static_cast<const Row*>(data);
  offset = px::PxVec3(0);
  at_A = A.p;
  at_B = B.p;
  scale = px::PxConstraintInvMassScale(1, 1, 1, 1);
  rows[0].linear0 = rows[0].linear1 = px::PxVec3(0);
  rows[0].angular0 = rows[0].angular1 = A.rotate(row.axis);
  rows[0].geometricError = 0;
  rows[0].velocityTarget = 0;
  rows[0].minImpulse = -row.torque;
  rows[0].maxImpulse = row.torque;
  rows[0].flags = px::Px1DConstraintFlag::eHAS_DRIVE_LIMIT;
  return 1;
}

}  // namespace crossgait::physx
