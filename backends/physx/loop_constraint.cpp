#include "backends/physx/loop_constraint.h"

#include <array>

#include "backends/physx/convert.h"

namespace crossgait::physx {

LoopConstraint::LoopConstraint(px::PxPhysics& physics, px::PxArticulationLink& a, const Vector3& p_A,
                               px::PxArticulationLink& b, const Vector3& p_B, const std::optional<Soft>& soft)
    : a_(a), b_(b), soft_(soft), rows_{vector(p_A), vector(p_B)} {
  make(physics, a, b, prepare, &rows_, sizeof(Rows));
}

// A damper that acts in full within the step gives an impulse y with  J v' + y / (h c) = target.
void LoopConstraint::begin_step(const px::PxSpatialVelocity& a, const px::PxSpatialVelocity& b) {
  if (!soft_) return;
  const px::PxTransform A = a_.getGlobalPose(), B = b_.getGlobalPose();
  const Vector3 arm_A = vector(A.q.rotate(rows_.a)), arm_B = vector(B.q.rotate(rows_.b));
  const Vector3 gap = vector(A.p) + arm_A - vector(B.p) - arm_B;
  const Vector3 speed =
      vector(a.linear) + vector(a.angular).cross(arm_A) - vector(b.linear) - vector(b.angular).cross(arm_B);
  const double imp = soft_->law.impedance(gap.norm());
  rows_.target = vector(Vector3(soft_->law.target_velocity(speed, imp, gap)));
  rows_.damping = static_cast<float>(1 / (soft_->step * SoftLaw::regularization(imp, soft_->inverse_weight)));
  changed();
}

px::PxU32 LoopConstraint::prepare(px::Px1DConstraint* rows, px::PxVec3p& offset, px::PxU32 /*most*/,
                                  px::PxConstraintInvMassScale& scale, const void* data,
                                  const px::PxTransform& A, const px::PxTransform& B,
                                  bool /*extended_limits*/, px::PxVec3p& at_A, px::PxVec3p& at_B) {
  const auto& own = *static_cast<const Rows*>(data);
  const px::PxVec3 p_A = A.transform(own.a), p_B = B.transform(own.b), gap = p_A - p_B;
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
    row.velocityTarget = own.target.dot(axes[i]);
    row.minImpulse = -PX_MAX_F32;
    row.maxImpulse = PX_MAX_F32;
    row.flags = 0;
    if (own.damping == 0) continue;
    row.flags = px::Px1DConstraintFlag::eSPRING;
    row.mods.spring.stiffness = 0;
    row.mods.spring.damping = own.damping;
  }
  return static_cast<px::PxU32>(axes.size());
}

}  // namespace crossgait::physx
