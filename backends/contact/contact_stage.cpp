#include "crossgait/backends/contact/contact_stage.h"

#include <algorithm>
#include <cmath>

#include "crossgait/physics/multibody.h"

namespace crossgait::contact {
namespace {

// Gauss-Seidel converges linearly where MuJoCo's Newton converges quadratically: the same tolerance asks for
// more.
constexpr double kSweepTolerance = 1e-3;
constexpr double kRoundingFloor = 1e-15;
constexpr int kMaxSweeps = 1000;
// mjMINMU of mjmodel.h: MuJoCo's contacts are never quite without friction.
constexpr double kMinFriction = 1e-5;
// Bullet's default, btContactSolverInfo::m_erp2.
constexpr double kErrorReduction = 0.2;

Matrix3 contact_frame(const Vector3& normal) {
  const Vector3 helper = std::abs(normal.y()) < 0.5 ? Vector3::UnitY() : Vector3::UnitZ();
  Matrix3 frame;
  frame.row(0) = normal;
  frame.row(1) = (helper - normal * normal.dot(helper)).normalized();
  frame.row(2) = normal.cross(frame.row(1).transpose());
  return frame;
}

}  // namespace

ContactStage::ContactStage(const WorldSpec& spec, const LawFactors& factors, const BodyKinematics& bodies,
                           const JointStage& joints)
    : spec_(spec),
      factors_(factors),
      bodies_(bodies),
      joints_(joints),
      contact_law_(spec.contact.softness, spec.physics_dt),
      friction_law_(spec.robot->friction_softness, spec.physics_dt),
      inverse_weights_(translational_inverse_weights(*spec.robot, spec.fixed_base)),
      frictional_joints_(contact::frictional_joints(spec)) {
  const Eigen::Index n = joints_.inertia().dofs();
  rows_.setZero(n, ConeProblem::kMaxRows);
  projected_.setZero(n, ConeProblem::kMaxRows);
  joint_friction_.count = static_cast<int>(frictional_joints_.size());
  joint_rows_.setZero(n, joint_friction_.count);
  projected_joints_.setZero(n, joint_friction_.count);
}

const DofVector& ContactStage::solve(const DofVector& before, const ContactPoints& points) noexcept {
  velocity_ = joints_.velocity();
  if (points.count == 0 && frictional_joints_.empty()) return velocity_;
  assemble(before, points);
  const double tolerance = std::max(kRoundingFloor, kSweepTolerance * spec_.solver.tolerance);
  if (!frictional_joints_.empty()) {
    assemble_joint_friction(before);
    joint_friction_.solve(cone_, factors_.coulomb, tolerance, kMaxSweeps);
    cone_.x.head(3 * points.count) = joint_friction_.contact_impulses().head(3 * points.count);
  } else if (factors_.coulomb) {
    cone_.solve_coulomb(tolerance, kMaxSweeps);
  } else {
    cone_.solve(tolerance, kMaxSweeps);
  }
  apply(points);
  return velocity_;
}

// Writes a row's regularisation on the diagonal. @returns the velocity that the row asks for, m/s
double ContactStage::set_row(const ContactPoint& point, int contact, int axis) noexcept {
  double& regularization = cone_.A(3 * contact + axis, 3 * contact + axis);
  if (axis == 0 ? factors_.hard_normal : factors_.hard_friction) {
    regularization = 0;
    if (axis > 0) return 0;
    const double h = spec_.physics_dt;  // a gap may close, of a penetration a share is undone
    return point.distance > 0 ? -point.distance / h : -kErrorReduction * point.distance / h;
  }
  const double imp = contact_law_.impedance(point.distance);
  const double R = SoftLaw::regularization(imp, inverse_weights_[static_cast<std::size_t>(point.body)]);
  // Friction rows share the normal's impedance and damping, without a spring.
  regularization = axis == 0 ? R : R / spec_.contact.impratio;
  return contact_law_.target_velocity(velocity_before_[static_cast<std::size_t>(contact)][axis], imp,
                                      axis == 0 ? point.distance : 0.0);
}

void ContactStage::assemble(const DofVector& before, const ContactPoints& points) noexcept {
  const Eigen::Index rows = 3 * points.count;
  for (int i = 0; i < points.count; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const ContactPoint& point = points.points[k];
    // On the robot's surface, or midway between the surfaces.
    const Vector3 p_WP = factors_.surface ? point.p_WP + point.distance / 2 * point.normal : point.p_WP;
    bodies_.point_jacobian(point.body, p_WP, J_);
    frames_[k] = contact_frame(point.normal);
    J_ = (frames_[k] * J_).eval();
    velocity_before_[k].noalias() = J_ * before;

    for (int r = 0; r < 3; ++r) {
      const Eigen::Index row = 3 * i + r;
      const double target = set_row(point, i, r);
      cone_.b[row] = J_.row(r).dot(joints_.velocity()) - target;
      rows_.col(row) = J_.row(r).transpose();
      respond(row, rows_, projected_);
    }
  }
  for (Eigen::Index c = 0; c < rows; ++c) {
    const double regularization = cone_.A(c, c);
    cone_.A.col(c).head(rows).noalias() = rows_.leftCols(rows).transpose() * projected_.col(c);
    cone_.A(c, c) += regularization;
  }
  cone_.contacts = points.count;
  cone_.friction = std::max(spec_.contact.friction, kMinFriction);
}

// From a row's J', in a column, the response of the machine to it: half_solve(J'), and what remains of it.
void ContactStage::respond(Eigen::Index column, Eigen::MatrixXd& rows,
                           Eigen::MatrixXd& projected) const noexcept {
  joints_.inertia().half_solve(rows.col(column));
  projected.col(column) = rows.col(column);
  joints_.project(projected.col(column));
}

void ContactStage::apply(const ContactPoints& points) noexcept {
  const Eigen::Index rows = 3 * points.count;
  DofVector change = projected_.leftCols(rows) * cone_.x.head(rows);
  if (joint_friction_.count > 0) add_joint_friction(change);
  joints_.inertia().finish_solve(change);
  velocity_ += change;
  for (int i = 0; i < points.count; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    if (points.points[k].distance > 0 && cone_.x[3 * i] <= 0) continue;  // speculative
    const Matrix3 to_world = frames_[k].transpose();
    report(points.points[k], to_world * cone_.x.segment<3>(3 * i) / spec_.physics_dt,
           to_world * velocity_before_[k]);
  }
  contacts_.dropped = points.dropped;
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
