// bullet:own, by the code of Bullet's library as it ships: hard contact (position error reduction erp2 = 0.2,
// no softness), friction bounded by the normal impulse of the sweep, motors for the dry friction of joints.
// Two changes: rows respond through the joint stage (armature, closed loops) instead of the bare tree, and
// penetrations are undone no faster than the world allows (ContactSpec::max_depenetration_velocity).
#include <algorithm>
#include <cmath>

#include <BulletDynamics/Featherstone/btMultiBodyJointLimitConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>

#include "backends/bullet/constraint_solver.h"
#include "backends/bullet/convert.h"
#include "backends/contact/law_factors.h"

namespace crossgait::bullet {
namespace {

// A row between robot and terrain stores its Jacobian on whichever side the robot is.
int jacobian_index(const btMultiBodySolverConstraint& row) {
  return row.m_multiBodyA != nullptr ? row.m_jacAindex : row.m_jacBindex;
}

// Bullet clips the two friction impulses of a point to the cone after a step in each that it scales by that
// direction's own response. Unless both are scaled alike, friction is not opposed to slip (a sled is dragged
// off its line of fall and accelerates 4 % too much); where nothing slips the scale makes no difference.
void scale_alike(btMultiBodySolverConstraint& a, btMultiBodySolverConstraint& b) {
  const btScalar inverse = std::min(a.m_jacDiagABInv, b.m_jacDiagABInv);
  for (btMultiBodySolverConstraint* row : {&a, &b}) {
    row->m_rhs *= inverse / row->m_jacDiagABInv;
    row->m_cfm *= inverse / row->m_jacDiagABInv;
    row->m_jacDiagABInv = inverse;
  }
}

}  // namespace

// What Bullet makes of friction in a joint: a motor that wants it at rest; and its limits, which act on
// angles beyond them. (No world ever holds them, which would leave out those of a robot without colliders.)
void ConstraintSolver::make_joint_rows() {
  for (const contact::FrictionalJoint& joint : contacts_.frictional_joints())
    joint_rows_.push_back(std::make_unique<btMultiBodyJointMotor>(&model_.body(), joint.joint, 0,
                                                                  spec_.physics_dt * joint.friction));
  for (const contact::LimitedJoint& joint : contacts_.limited_joints())
    joint_rows_.push_back(std::make_unique<btMultiBodyJointLimitConstraint>(&model_.body(), joint.joint,
                                                                            joint.lower, joint.upper));
  for (const auto& rows : joint_rows_) {
    rows->finalizeMultiDof();
    joint_row_list_.push_back(rows.get());
  }
}

btScalar ConstraintSolver::solveGroupCacheFriendlySetup(btCollisionObject** bodies, int body_count,
                                                        btPersistentManifold** manifolds, int manifold_count,
                                                        btTypedConstraint** constraints, int constraint_count,
                                                        const btContactSolverInfo& info,
                                                        btIDebugDraw* drawer) {
  const btScalar result = btMultiBodyConstraintSolver::solveGroupCacheFriendlySetup(
      bodies, body_count, manifolds, manifold_count, constraints, constraint_count, info, drawer);
  set_velocity(joints_.velocity());
  for (int i = 0; i < m_multiBodyNonContactConstraints.size(); ++i) {
    btMultiBodySolverConstraint& row = m_multiBodyNonContactConstraints[i];
    if (const auto* limit = dynamic_cast<const btMultiBodyJointLimitConstraint*>(row.m_orgConstraint))
      bound_correction(row, -static_cast<double>(limit->getPosition(row.m_orgDofIndex)),
                       contact::kLimitReduction, contact::kFastestReturn);
    refer_to_joint_stage(row, 0);
  }
  for (int i = 0; i < m_multiBodyNormalContactConstraints.size(); ++i) {
    btMultiBodySolverConstraint& row = m_multiBodyNormalContactConstraints[i];
    const auto* point = static_cast<const btManifoldPoint*>(row.m_originalContactPoint);
    bound_correction(row, -static_cast<double>(point->getDistance()), spec_.contact.erp,
                     spec_.contact.max_depenetration_velocity);
    refer_to_joint_stage(row, spec_.contact.cfm);
  }
  for (int i = 0; i < m_multiBodyFrictionContactConstraints.size(); ++i) {
    refer_to_joint_stage(m_multiBodyFrictionContactConstraints[i], spec_.contact.cfm);
  }
  for (int i = 0; i + 1 < m_multiBodyFrictionContactConstraints.size(); i += 2) {
    scale_alike(m_multiBodyFrictionContactConstraints[i], m_multiBodyFrictionContactConstraints[i + 1]);
  }
  return result;
}

// Takes from a row, which undoes `share` of its violation (m or rad) in the step, what is beyond the speed
// `fastest`.
void ConstraintSolver::bound_correction(btMultiBodySolverConstraint& row, double violation, double share,
                                        double fastest) const noexcept {
  const double excess = share * violation / spec_.physics_dt - fastest;
  if (excess > 0) row.m_rhs -= excess * row.m_jacDiagABInv;
}

// Bullet iterates  dlambda = rhs - lambda cfm - (J dv) / (d + C)  with d = J M0^-1 J'. Replaces M0^-1 J' by
// the response of the whole machine and the right-hand side by what the joint stage left to do.
// `mixing` is added to its response to itself, as a share of it.
void ConstraintSolver::refer_to_joint_stage(btMultiBodySolverConstraint& row, double mixing) noexcept {
  const int at = jacobian_index(row);
  const Eigen::Index n = before_.size();
  const Eigen::Map<const Eigen::VectorXd> J(&m_data.m_jacobians[at], n);
  Eigen::Map<Eigen::VectorXd> response(&m_data.m_deltaVelocitiesUnitImpulse[at], n);

  const double softness = row.m_cfm / row.m_jacDiagABInv;
  const double wanted = row.m_rhs / row.m_jacDiagABInv - J.dot(correction_);
  DofVector y = J;
  joints_.inertia().half_solve(y);
  joints_.project(y);
  joints_.inertia().finish_solve(y);
  response = y;
  const double answer = J.dot(y), added = softness + mixing * answer;
  const double inverse = 1 / (answer + added);
  row.m_jacDiagABInv = inverse;
  row.m_cfm = added * inverse;
  row.m_rhs = wanted * inverse;
}

btScalar ConstraintSolver::solveGroupCacheFriendlyFinish(btCollisionObject** bodies, int body_count,
                                                         const btContactSolverInfo& info) {
  report_native_contacts();
  return btMultiBodyConstraintSolver::solveGroupCacheFriendlyFinish(bodies, body_count, info);
}

void ConstraintSolver::report_native_contacts() noexcept {
  const double h = spec_.physics_dt;
  const Eigen::Index n = before_.size();
  const auto impulse = [&](const btMultiBodySolverConstraint& row) {
    const btVector3& direction = row.m_multiBodyA != nullptr ? row.m_contactNormal1 : row.m_contactNormal2;
    return Vector3(vector(direction) * static_cast<double>(row.m_appliedImpulse));
  };
  for (int i = 0; i < m_multiBodyNormalContactConstraints.size(); ++i) {
    const btMultiBodySolverConstraint& row = m_multiBodyNormalContactConstraints[i];
    const auto* p = static_cast<const btManifoldPoint*>(row.m_originalContactPoint);
    if (static_cast<double>(p->getDistance()) > 0 && static_cast<double>(row.m_appliedImpulse) <= 0)
      continue;  // speculative
    const bool robot_first = row.m_multiBodyA != nullptr;
    const int link = robot_first ? row.m_linkA : row.m_linkB;
    contact::ContactPoint point;
    point.body = link + 1;
    point.leg = leg_at(link, vector(robot_first ? p->m_positionWorldOnA : p->m_positionWorldOnB));
    point.p_WP = 0.5 * (vector(p->m_positionWorldOnA) + vector(p->m_positionWorldOnB));
    point.normal = vector(p->m_normalWorldOnB) * (robot_first ? 1.0 : -1.0);
    point.distance = p->getDistance();
    Vector3 force = impulse(row);
    for (int k = 0; k < 2; ++k) {
      force += impulse(m_multiBodyFrictionContactConstraints[row.m_frictionIndex + k]);
    }
    composite_.point_jacobian(link, point.p_WP, J_);
    contacts_.report(point, force / h, J_ * before_.head(n));
  }
}

}  // namespace crossgait::bullet
