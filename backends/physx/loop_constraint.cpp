#include "backends/physx/loop_constraint.h"

#include <array>

#include "backends/physx/convert.h"

namespace crossgait::physx {

LoopConstraint::LoopConstraint(px::PxPhysics& physics, px::PxArticulationLink& a, const Vector3& p_A,
                               px::PxArticulationLink& b, const Vector3& p_B)
    : points_{vector(p_A), vector(p_B)} {
  make(physics, a, b, prepare, &points_, sizeof(Points));
}

px::PxU32 LoopConstraint::prepare(px::Px1DConstraint* rows, px::PxVec3p& offset, px::PxU32 /*most*/,
                                  px::PxConstraintInvMassScale& scale, const void* data,
                                  const px::PxTransform& A, const px::PxTransform& B,
                                  bool /*extended_limits*/, px::PxVec3p& at_A, px::PxVec3p& at_B) {
  const auto& points = *static_cast<const Points*>(data);
  const px::PxVec3 p_A = A.transform(points.a), p_B = B.transform(points.b), gap = p_A - p_B;
  offset = p_A - A.p;
  at_A = p_A;
  at_B = p_B;
  scale = px::PxConstraintInvMassScale(1, 1, 1, 1);
  const std::array<px::PxVec3, 3> axes{px::PxVec3(1, 0, 0), px::PxVec3(0, 1, 0), px::PxVec3(0, 0, 1)};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    px::Px1DConstraint& row = rows[i];
    row.linear0 = row.linear1 = axes[i];
    row.angular0 = (p_A - A.p).cross(axes[i]);
    row.angular1 = (p_B - B.p).cross(axes[i]);
    row.geometricError = gap.dot(axes[i]);
    row.velocityTarget = 0;
    row.minImpulse = -PX_MAX_F32;
    row.maxImpulse = PX_MAX_F32;
    row.flags = 0;
  }
  return static_cast<px::PxU32>(axes.size());
}

}  // namespace crossgait::physx
