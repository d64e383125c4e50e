#include "backends/bullet/constraint_solver.h"

#include "backends/bullet/convert.h"

namespace crossgait::bullet {
namespace {

contact::BodyKinematics kinematics(const MultibodyModel& model, const CompositeInertia& composite) {
  const btMultiBody& body = model.body();
  return {model.X_BP(),
          [&body](int i, const Vector3& p_CP) { return vector(body.localPosToWorld(i - 1, vector(p_CP))); },
          [&body](int i, const Vector3& v_C) { return vector(body.localDirToWorld(i - 1, vector(v_C))); },
          [&composite](int i, const Vector3& p_WP, PointJacobian& J) {
            composite.point_jacobian(i - 1, p_WP, J);
          }};
}

}  // namespace

ConstraintSolver::ConstraintSolver(const WorldSpec& spec, const ContactFactors& factors, bool own_code,
                                   MultibodyModel& model)
    : spec_(spec),
      factors_(factors),
      own_code_(own_code),
      model_(model),
      composite_(model.body()),
      bodies_(kinematics(model, composite_)),
      joints_(spec, bodies_),
      finder_(model.contact_features(), spec.terrain,
              factors.speculative ? contact_margins(model.contact_features(), model.body().getNumLinks())
                                  : std::vector<double>()),
      contacts_(spec, factors, bodies_, joints_, factors.sweeps),
      torque_(JointVector::Zero(spec.robot->joint_count())),
      angles_(torque_) {
  const Eigen::Index n = joints_.inertia().dofs();
  before_.setZero(n);
  correction_.setZero(n);
  if (own_code_) make_joint_rows();
}

DofVector ConstraintSolver::bullet_velocity() const noexcept {
  return Eigen::Map<const Eigen::VectorXd>(model_.body().getVelocityVector(), before_.size());
}

void ConstraintSolver::set_velocity(const DofVector& velocity) noexcept {
  btMultiBody& body = model_.body();
  body.setBaseOmega(vector(Vector3(velocity.head<3>())));
  body.setBaseVel(vector(Vector3(velocity.segment<3>(3))));
  for (int i = 0; i < body.getNumLinks(); ++i) body.setJointVel(i, velocity[6 + i]);
}

void ConstraintSolver::begin_step(const JointVector& torque, std::span<const ImplicitServo> servos) noexcept {
  before_ = bullet_velocity();
  torque_ = torque;
  servos_ = servos;
  contacts_.begin_step();
  pending_ = true;
  finite_ = true;
}

void ConstraintSolver::solveMultiBodyGroup(btCollisionObject** bodies, int body_count,
                                           btPersistentManifold** manifolds, int manifold_count,
                                           btTypedConstraint** constraints, int constraint_count,
                                           btMultiBodyConstraint** /*multibody_constraints*/,
                                           int /*multibody_constraint_count*/,
                                           const btContactSolverInfo& info, btIDebugDraw* drawer,
                                           btDispatcher* dispatcher) {
  if (!pending_) return;  // Bullet also calls for empty groups
  pending_ = false;
  const DofVector after_dynamics = bullet_velocity();
  composite_.update(joints_.inertia());
  for (int i = 0; i < model_.body().getNumLinks(); ++i) angles_[i] = model_.body().getJointPos(i);
  joints_.inertia().multiply_bare(after_dynamics - before_, impulse_);
  joints_.solve(before_, impulse_, angles_, torque_);
  if (!joints_.velocity().allFinite()) {
    finite_ = false;
    set_velocity(DofVector::Zero(before_.size()));
    return;
  }
  if (!own_code_) {
    points_.clear();
    if (factors_.narrowphase) {
      read_contacts(manifolds, manifold_count);
    } else {
      finder_.find(bodies_, points_);
    }
    set_velocity(contacts_.solve(before_, angles_, points_, servos_));
    return;
  }
  correction_ = joints_.velocity() - after_dynamics;
  btMultiBodyConstraintSolver::solveMultiBodyGroup(
      bodies, body_count, manifolds, manifold_count, constraints, constraint_count, joint_row_list_.data(),
      static_cast<int>(joint_row_list_.size()), info, drawer, dispatcher);
  if (!bullet_velocity().allFinite()) {
    finite_ = false;
    set_velocity(DofVector::Zero(before_.size()));
  }
}

}  // namespace crossgait::bullet
