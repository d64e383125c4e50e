#include "backends/contact/contact_stage.h"

#include <algorithm>
#include <cmath>

#include "backends/contact/convergence.h"
#include "physics/core/error.h"
#include "physics/robot/actuator.h"
#include "physics/robot/multibody.h"

namespace crossgait::contact {
namespace {

// Rows: the normal, the direction along the ground that is nearest to `along`, and the one across it.
Matrix3 contact_frame(const Vector3& normal, const Vector3& along) {
  Matrix3 frame;
  frame.row(0) = normal;
  frame.row(1) = (along - normal * normal.dot(along)).normalized();
  frame.row(2) = normal.cross(frame.row(1).transpose());
  return frame;
}

// Where the law does not care how tangents lie.
Matrix3 contact_frame(const Vector3& normal) {
  return contact_frame(normal, std::abs(normal.y()) < 0.5 ? Vector3::UnitY() : Vector3::UnitZ());
}

// DART's: across the world's z, or x where that is the normal (ContactConstraint::getTangentBasisMatrixODE).
Matrix3 stock_frame(const Vector3& normal) {
  constexpr double kParallel = 1e-6;
  Vector3 tangent = normal.cross(Vector3::UnitZ());
  if (tangent.norm() < kParallel) tangent = normal.cross(Vector3::UnitX());
  return contact_frame(normal, tangent);
}

// mjMINMU of mjmodel.h: MuJoCo's contacts are never quite without friction.
double at_least_some(double friction) noexcept { return std::max(friction, 1e-5); }

constexpr double kLeastShare = 1e-9;  // of a hard limit's response to itself

int count_implicit_servos(const RobotDescription& robot) {
  const std::vector<int> servos = robot.actuated_joints();
  return static_cast<int>(
      std::count_if(servos.begin(), servos.end(), [&](int i) { return is_implicit(robot.joint(i)); }));
}

template <typename Problem>
constexpr bool turns = false;
template <int kRows>
constexpr bool turns<PrimalProblemOf<kRows>> = kRows > 3;

}  // namespace

ContactStage::ContactStage(const WorldSpec& spec, const LawFactors& factors, const BodyKinematics& bodies,
                           const JointStage& joints, bool sweeps)
    : spec_(spec),
      factors_(factors),
      hard_(hard_contact(spec.contact, factors)),
      bodies_(bodies),
      joints_(joints),
      contact_law_(spec.contact.softness, spec.physics_dt),
      friction_law_(spec.robot->friction_softness, spec.physics_dt),
      inverse_weights_(translational_inverse_weights(*spec.robot, spec.fixed_base)),
      frictional_joints_(contact::frictional_joints(spec)),
      limited_joints_(contact::limited_joints(spec)),
      sweeps_(sweeps) {
  loops_.setZero(joints_.inertia().dofs(), joints_.row_count());
  const bool hard = factors_.hard_normal || factors_.hard_friction ||
                    (factors_.hard_joint_friction && !frictional_joints_.empty()) ||
                    (factors_.hard_joint_limits && !limited_joints_.empty());
  const int dofs = joints_.inertia().dofs(), servos = count_implicit_servos(*spec.robot);
  const FrictionBound bound = factors_.stock     ? FrictionBound::kFrictionlessPyramid
                              : factors_.pyramid ? FrictionBound::kPyramid
                                                 : FrictionBound::kDisc;
  if (!factors_.hard_friction && spec.contact.cone == FrictionCone::kPyramidal)
    throw ConfigError("world specification", "contact.cone", "elliptic, outside of MuJoCo itself",
                      "pyramidal");
  if (!hard && !factors_.coulomb) {
    const auto& coupled = joints_.coupled_dofs();
    const int rows = is_solved_by_minimum(factors_) ? spec.contact.condim : 3;
    if (rows == 6) {
      rolling_ = std::make_unique<PrimalProblemOf<6>>(dofs, coupled, coefficient());
    } else if (rows == 4) {
      twisting_ = std::make_unique<PrimalProblemOf<4>>(dofs, coupled, coefficient());
    } else {
      primal_ = std::make_unique<PrimalProblem>(dofs, coupled, coefficient());
    }
  } else if (const bool only_contacts = frictional_joints_.empty() && servos == 0;
             bound == FrictionBound::kDisc && (sweeps_ || (factors_.coulomb && only_contacts))) {
    sweep_ = std::make_unique<SweepProblem>(dofs, joints_.coupled_dofs(), coefficient(), hard_.mixing);
  } else {
    dual_ = std::make_unique<DualProblem>(
        joints_, static_cast<int>(frictional_joints_.size() + limited_joints_.size()) + servos, bound,
        hard_.mixing);
  }
  for (int body = 0; body <= spec.robot->joint_count(); ++body)
    dofs_.push_back(joints_.inertia().dofs_of(body));
}

const DofVector& ContactStage::solve(const DofVector& before, const JointVector& angles,
                                     const ContactPoints& points,
                                     std::span<const ImplicitServo> servos) noexcept {
  velocity_ = joints_.velocity();
  find_limits(before, angles);
  if (points.count == 0 && frictional_joints_.empty() && limit_count_ == 0 && servos.empty())
    return velocity_;
  if (primal_) {
    solve_primal(*primal_, before, points, servos);
  } else if (twisting_) {
    solve_primal(*twisting_, before, points, servos);
  } else if (rolling_) {
    solve_primal(*rolling_, before, points, servos);
  } else if (sweep_) {
    sweep_->begin(joints_.row_count() > 0 ? &joints_.held_inertia() : nullptr);
    add_rows(*sweep_, before, points, servos);
    sweep();
    apply(*sweep_, points);
  } else {
    dual_->begin();
    add_rows(*dual_, before, points, servos);
    dual_->solve(coefficient(), factors_.coulomb, spec_.solver.tolerance);
    apply(*dual_, points);
  }
  return velocity_;
}

template <typename Primal>
void ContactStage::solve_primal(Primal& problem, const DofVector& before, const ContactPoints& points,
                                std::span<const ImplicitServo> servos) noexcept {
  joints_.scaled_loop_rows(loops_);
  problem.begin(joints_.loop_inertia(), loops_);
  add_rows(problem, before, points, servos);
  DofVector guess = before - velocity_;  // as if nothing were accelerated
  joints_.inertia().half_multiply(guess);
  problem.solve(guess, spec_.solver.tolerance);
  apply(problem, points);
}

JointVector ContactStage::joint_friction() const {
  JointVector friction = JointVector::Zero(spec_.robot->joint_count());
  for (const FrictionalJoint& joint : frictional_joints_) friction[joint.joint] = joint.friction;
  return friction;
}

JointRanges ContactStage::joint_limits() const {
  JointRanges limits(spec_.robot->joint_count());
  for (const LimitedJoint& joint : limited_joints_) {
    limits.lower[joint.joint] = joint.lower;
    limits.upper[joint.joint] = joint.upper;
  }
  return limits;
}

void ContactStage::find_limits(const DofVector& before, const JointVector& angles) noexcept {
  limit_count_ = 0;
  for (const LimitedJoint& joint : limited_joints_) {
    const int dof = 6 + joint.joint;
    const auto row = limit_row(joint, factors_.hard_joint_limits, angles[joint.joint], before[dof],
                               velocity_[dof], spec_.physics_dt);
    if (row) limits_[static_cast<std::size_t>(limit_count_++)] = {dof, *row};
  }
}

double ContactStage::coefficient() const noexcept { return at_least_some(spec_.contact.friction); }

void ContactStage::sweep() noexcept {
  const SolverSpec& solver = spec_.solver;
  if (sweeps_) {
    sweep_->sweep(solver.iterations, solver.tolerance);
  } else {
    sweep_->converge(kMaxSweeps, std::max(kRoundingFloor, kSweepTolerance * solver.tolerance));
  }
}

template <typename Problem>
void ContactStage::add_rows(Problem& problem, const DofVector& before, const ContactPoints& points,
                            std::span<const ImplicitServo> servos) noexcept {
  for (int i = 0; i < points.count; ++i) {
    const ContactPoint& point = points.points[static_cast<std::size_t>(i)];
    ContactRows& rows = rows_[static_cast<std::size_t>(i)];
    describe(point, before, rows);
    if constexpr (turns<Problem>) {
      add_turning_contact(problem, before, point, rows);
    } else {
      joints_.inertia().half_solve_rows(dofs_of(point.body), J_);
      problem.add_contact(dofs_of(point.body), J_, rows.R, rows.b);
    }
  }
  add_joint_rows(problem, before);
  add_servos(problem, before, servos);
}

template <typename Problem>
void ContactStage::add_joint_rows(Problem& problem, const DofVector& before) noexcept {
  for (const FrictionalJoint& joint : frictional_joints_) {
    const int dof = 6 + joint.joint;
    const auto [R, target] = friction_row(joint, friction_law_, factors_.hard_joint_friction, before[dof]);
    DofVector z = DofVector::Unit(before.size(), dof);
    joints_.inertia().half_solve(z);
    const double bound = spec_.physics_dt * joint.friction;
    problem.add_bounded(dofs_of(joint.joint + 1), z, R, velocity_[dof] - target, {-bound, bound});
  }
  for (int i = 0; i < limit_count_; ++i) {
    const auto& [dof, row] = limits_[static_cast<std::size_t>(i)];
    DofVector z = row.away * DofVector::Unit(before.size(), dof);
    joints_.inertia().half_solve(z);
    // A hard limit and hard friction of one joint would be the same row twice.
    const double R = row.R > 0 ? row.R : kLeastShare * z.squaredNorm();
    problem.add_bounded(dofs_of(dof - 5), z, R, row.away * velocity_[dof] - row.target, kOnlyPushes);
  }
}

// With x = h tau, tau = torque - inertia (v' - v) / h is  v' + x / inertia = v + h torque / inertia.
template <typename Problem>
void ContactStage::add_servos(Problem& problem, const DofVector& before,
                              std::span<const ImplicitServo> servos) noexcept {
  const double h = spec_.physics_dt;
  for (const ImplicitServo& servo : servos) {
    const int dof = 6 + servo.joint;
    const double target = before[dof] + h * servo.torque / servo.inertia;
    DofVector z = DofVector::Unit(before.size(), dof);
    joints_.inertia().half_solve(z);
    problem.add_bounded(dofs_of(servo.joint + 1), z, 1 / servo.inertia, velocity_[dof] - target,
                        {h * servo.lower, h * servo.upper});
  }
}

template <typename Problem>
void ContactStage::apply(const Problem& problem, const ContactPoints& points) noexcept {
  DofVector change = problem.u();
  joints_.inertia().finish_solve(change);
  velocity_ += change;
  for (int i = 0; i < points.count; ++i) {
    const ContactPoint& point = points.points[static_cast<std::size_t>(i)];
    const ContactRows& rows = rows_[static_cast<std::size_t>(i)];
    const Vector3 impulse = problem.contact_impulse(i).template head<3>();
    if (point.distance > 0 && impulse[0] <= 0) continue;  // speculative
    report(point, rows.frame.transpose() * impulse / spec_.physics_dt,
           rows.frame.transpose() * rows.velocity_before);
  }
  contacts_.dropped = points.dropped;
}

// On the robot's surface, or midway between the surfaces.
Vector3 ContactStage::place_of_force(const ContactPoint& point) const noexcept {
  return factors_.surface ? point.p_WP + point.distance / 2 * point.normal : point.p_WP;
}

// In turning_ the body's angular velocity per unit of each dof, from how points a metre apart move.
void ContactStage::find_turning(int body, const Vector3& p_WP) noexcept {
  bodies_.point_jacobian(body, p_WP, turning_);
  bodies_.point_jacobian(body, p_WP + Vector3::UnitX(), along_x_);
  bodies_.point_jacobian(body, p_WP + Vector3::UnitY(), along_y_);
  for (const int dof : dofs_of(body)) {
    const Vector3 x = along_x_.col(dof) - turning_.col(dof), y = along_y_.col(dof) - turning_.col(dof);
    turning_.col(dof) = Vector3(y.z(), -x.z(), x.y());  // w x ex = (0, wz, -wy), w x ey = (-wz, 0, wx)
  }
}

// Torsion about the normal and rolling about the tangents, after the rows of `describe`. Their regularisation
// is such that friction of all rows shares one round cone (MuJoCo 2.2, mj_makeImpedance).
template <int kRows>
void ContactStage::add_turning_contact(PrimalProblemOf<kRows>& problem, const DofVector& before,
                                       const ContactPoint& point, const ContactRows& rows) noexcept {
  typename PrimalProblemOf<kRows>::Rows R, b;
  R.template head<3>() = rows.R;
  b.template head<3>() = rows.b;
  const Vector3 p_WP = place_of_force(point);
  find_turning(point.body, p_WP);
  Vector3 turning_before = Vector3::Zero(), turning = Vector3::Zero();
  for (const int dof : dofs_of(point.body)) {
    const Vector3 column = rows.frame * turning_.col(dof);
    turning_.col(dof) = column;
    turning_before += before[dof] * column;
    turning += joints_.velocity()[dof] * column;
  }
  const ContactSpec& contact = spec_.contact;
  for (int k = 3; k < kRows; ++k) {
    const double own = at_least_some(k == 3 ? contact.torsional_friction : contact.rolling_friction);
    const double share = coefficient() / own;
    R[k] = rows.R[1] * share * share;
    b[k] = turning[k - 3] - contact_law_.target_velocity(turning_before[k - 3], rows.impedance, 0);
  }
  joints_.inertia().half_solve_rows(dofs_of(point.body), J_);
  joints_.inertia().half_solve_rows(dofs_of(point.body), turning_);
  typename PrimalProblemOf<kRows>::RowsJacobian Z(kRows, J_.cols());
  for (const int dof : dofs_of(point.body)) {
    Z.col(dof).template head<3>() = J_.col(dof);
    Z.col(dof).template tail<kRows - 3>() = turning_.col(dof).template head<kRows - 3>();
  }
  problem.add_contact(dofs_of(point.body), Z, R, b);
}

// A contact's rows, and in J_ its Jacobian in its own frame: by the dofs that move the body.
void ContactStage::describe(const ContactPoint& point, const DofVector& before, ContactRows& rows) noexcept {
  const Vector3 p_WP = place_of_force(point);
  bodies_.point_jacobian(point.body, p_WP, J_);
  rows.frame = frame_at(point, before);
  rows.velocity_before.setZero();
  rows.b.setZero();
  for (const int dof : dofs_of(point.body)) {
    const Vector3 column = rows.frame * J_.col(dof);
    J_.col(dof) = column;
    rows.velocity_before += before[dof] * column;
    rows.b += joints_.velocity()[dof] * column;
  }
  for (int axis = 0; axis < 3; ++axis) rows.b[axis] -= set_row(point, axis, rows);
}

// Where a contact's rows point. In J_ is its Jacobian in W.
Matrix3 ContactStage::frame_at(const ContactPoint& point, const DofVector& before) const noexcept {
  if (factors_.stock) return stock_frame(point.normal);
  if (factors_.pyramid) {
    constexpr double kStill = 1e-9;  // m/s: no direction
    Vector3 slip = Vector3::Zero();
    for (const int dof : dofs_of(point.body)) slip += before[dof] * J_.col(dof);
    slip -= point.normal * point.normal.dot(slip);
    if (slip.norm() > kStill) return contact_frame(point.normal, slip);
  }
  return contact_frame(point.normal);
}

// Sets a row's regularisation. @returns the velocity that the row asks for, m/s
double ContactStage::set_row(const ContactPoint& point, int axis, ContactRows& rows) const noexcept {
  double& regularization = rows.R[axis];
  if (axis == 0 ? factors_.hard_normal : factors_.hard_friction) {
    regularization = 0;
    if (axis > 0) return 0;
    const double h = spec_.physics_dt;  // a gap may close, of a penetration a share is undone
    if (point.distance > 0) return -point.distance / h;
    return std::min(-hard_.error_reduction * point.distance / h, hard_.most_push_out);
  }
  const double imp = rows.impedance = contact_law_.impedance(point.distance);
  const double R = SoftLaw::regularization(imp, inverse_weights_[static_cast<std::size_t>(point.body)]);
  // Friction rows share the normal's impedance and damping, without a spring.
  regularization = axis == 0 ? R : R / spec_.contact.impratio;
  return contact_law_.target_velocity(rows.velocity_before[axis], imp, axis == 0 ? point.distance : 0.0);
}

void ContactStage::report(const ContactPoint& point, const Vector3& force,
                          const Vector3& velocity_before) noexcept {
  Contact contact;
  contact.body = point.body;
  contact.leg = point.leg;
  contact.p_WP = point.p_WP;
  contact.normal = point.normal;
  contact.distance = point.distance;
  contact.force = force;
  contact.slip_speed = (velocity_before - point.normal * point.normal.dot(velocity_before)).norm();
  contacts_.add(contact);
}

}  // namespace crossgait::contact
