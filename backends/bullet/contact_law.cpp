// Contact, along with dry friction in joints, solved by Crossgait in Bullet's dynamics. With MuJoCo's factors
// contacts are placed midway between the surfaces, softened like MuJoCo's, and solved over true friction
// cones; any of these can be Bullet's.
#include <algorithm>
#include <cmath>

#include "crossgait/backends/bullet/constraint_solver.h"
#include "crossgait/backends/bullet/convert.h"

namespace crossgait::bullet {
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

void ConstraintSolver::solve_contacts() noexcept {
  if (points_.count == 0 && frictional_joints_.empty()) {
    set_velocity(joints_.velocity());
    return;
  }
  assemble_contacts();
  const double tolerance = std::max(kRoundingFloor, kSweepTolerance * spec_.solver.tolerance);
  if (!frictional_joints_.empty()) {
    assemble_joint_friction();
    joint_friction_.solve(cone_, factors_.coulomb, tolerance, kMaxSweeps);
    cone_.x.head(3 * points_.count) = joint_friction_.contact_impulses().head(3 * points_.count);
  } else if (factors_.coulomb) {
    cone_.solve_coulomb(tolerance, kMaxSweeps);
  } else {
    cone_.solve(tolerance, kMaxSweeps);
  }
  apply_contacts();
}

// Writes a row's regularisation on the diagonal. @returns the velocity that the row asks for, m/s
double ConstraintSolver::set_row(int contact, int axis) noexcept {
  const std::size_t k = static_cast<std::size_t>(contact);
  const ContactPoint& point = points_.points[k];
  double& regularization = cone_.A(3 * contact + axis, 3 * contact + axis);
  if (axis == 0 ? factors_.hard_normal : factors_.hard_friction) {
    regularization = 0;
    if (axis > 0) return 0;
    const double h = spec_.physics_dt;  // a gap may close, of a penetration a share is undone
    return point.distance > 0 ? -point.distance / h : -kErrorReduction * point.distance / h;
  }
  const double imp = contact_law_.impedance(point.distance);
  const double R =
      SoftLaw::regularization(imp, model_.inverse_weights()[static_cast<std::size_t>(point.link + 1)]);
  // Friction rows share the normal's impedance and damping, without a spring.
  regularization = axis == 0 ? R : R / spec_.contact.impratio;
  return contact_law_.target_velocity(velocity_before_[k][axis], imp, axis == 0 ? point.distance : 0.0);
}

void ConstraintSolver::assemble_contacts() noexcept {
  const JointSpaceInertia& inertia = joints_.inertia();
  const Eigen::Index rows = 3 * points_.count;
  for (int i = 0; i < points_.count; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const ContactPoint& point = points_.points[k];
    // On the robot's surface, or midway between the surfaces.
    const Vector3 p_WP = factors_.surface ? point.p_WP + point.distance / 2 * point.normal : point.p_WP;
    inertia.point_jacobian(point.link, p_WP, J_);
    frames_[k] = contact_frame(point.normal);
    J_ = (frames_[k] * J_).eval();
    velocity_before_[k].noalias() = J_ * before_;

    for (int r = 0; r < 3; ++r) {
      const Eigen::Index row = 3 * i + r;
      const double target = set_row(i, r);
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
  cone_.contacts = points_.count;
  cone_.friction = std::max(spec_.contact.friction, kMinFriction);
}

// From a row's J', in a column, the response of the machine to it: half_solve(J'), and what remains of it.
void ConstraintSolver::respond(Eigen::Index column, Eigen::MatrixXd& rows,
                               Eigen::MatrixXd& projected) const noexcept {
  joints_.inertia().half_solve(rows.col(column));
  projected.col(column) = rows.col(column);
  joints_.project(projected.col(column));
}

void ConstraintSolver::apply_contacts() noexcept {
  const Eigen::Index rows = 3 * points_.count;
  DofVector change = projected_.leftCols(rows) * cone_.x.head(rows);
  if (joint_friction_.count > 0) add_joint_friction(change);
  joints_.inertia().finish_solve(change);
  set_velocity(joints_.velocity() + change);
  for (int i = 0; i < points_.count; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    if (points_.points[k].distance > 0 && cone_.x[3 * i] <= 0) continue;  // speculative
    const Matrix3 to_world = frames_[k].transpose();
    report(points_.points[k], to_world * cone_.x.segment<3>(3 * i) / spec_.physics_dt,
           to_world * velocity_before_[k]);
  }
  contacts_.dropped = points_.dropped;
}

}  // namespace crossgait::bullet
