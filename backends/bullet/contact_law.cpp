// Matched mode: MuJoCo's contact law in Bullet's dynamics. Contacts are placed midway between the surfaces
// (Bullet places its own on them), softened like MuJoCo's, and solved over true friction cones.
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

Matrix3 contact_frame(const Vector3& normal) {
  const Vector3 helper = std::abs(normal.y()) < 0.5 ? Vector3::UnitY() : Vector3::UnitZ();
  Matrix3 frame;
  frame.row(0) = normal;
  frame.row(1) = (helper - normal * normal.dot(helper)).normalized();
  frame.row(2) = normal.cross(frame.row(1).transpose());
  return frame;
}

}  // namespace

void ConstraintSolver::solve_matched() noexcept {
  find_contacts();
  if (point_count_ == 0) {
    set_velocity(joints_.velocity());
    return;
  }
  assemble_contacts();
  const double tolerance = std::max(kRoundingFloor, kSweepTolerance * spec_.solver.tolerance);
  cone_.solve(tolerance, kMaxSweeps);
  apply_contacts();
}

void ConstraintSolver::find_contacts() noexcept {
  point_count_ = 0;
  const btMultiBody& body = model_.body();
  for (const ContactSphere& sphere : spheres_) {
    const Vector3 centre = vector(body.localPosToWorld(sphere.link, vector(sphere.p_CS)));
    SphereContact touch;
    if (!spec_.terrain.touch_sphere(centre, sphere.radius, touch)) continue;
    if (point_count_ < kMaxContacts) {
      points_[static_cast<std::size_t>(point_count_++)] = {sphere.link, sphere.leg, touch.position,
                                                           touch.normal, touch.distance};
    } else {
      ++contacts_.dropped;
    }
  }
}

void ConstraintSolver::assemble_contacts() noexcept {
  const JointSpaceInertia& inertia = joints_.inertia();
  const Eigen::Index rows = 3 * point_count_;
  for (int i = 0; i < point_count_; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const ContactPoint& point = points_[k];
    inertia.point_jacobian(point.link, point.p_WP, J_);
    frames_[k] = contact_frame(point.normal);
    J_ = (frames_[k] * J_).eval();
    velocity_before_[k].noalias() = J_ * before_;

    const double imp = contact_law_.impedance(point.distance);
    const double R =
        SoftLaw::regularization(imp, model_.inverse_weights()[static_cast<std::size_t>(point.link + 1)]);
    for (int r = 0; r < 3; ++r) {
      const Eigen::Index row = 3 * i + r;
      // Friction rows share the normal's impedance and damping, without a spring.
      const double target =
          contact_law_.target_velocity(velocity_before_[k][r], imp, r == 0 ? point.distance : 0.0);
      cone_.b[row] = J_.row(r).dot(joints_.velocity()) - target;
      rows_.col(row) = J_.row(r).transpose();
      inertia.half_solve(rows_.col(row));
      projected_.col(row) = rows_.col(row);
      joints_.project(projected_.col(row));
      cone_.A(row, row) = r == 0 ? R : R / spec_.contact.impratio;
    }
  }
  for (Eigen::Index c = 0; c < rows; ++c) {
    const double regularization = cone_.A(c, c);
    cone_.A.col(c).head(rows).noalias() = rows_.leftCols(rows).transpose() * projected_.col(c);
    cone_.A(c, c) += regularization;
  }
  cone_.contacts = point_count_;
  cone_.friction = std::max(spec_.contact.friction, kMinFriction);
}

void ConstraintSolver::apply_contacts() noexcept {
  const Eigen::Index rows = 3 * point_count_;
  DofVector change = projected_.leftCols(rows) * cone_.x.head(rows);
  joints_.inertia().finish_solve(change);
  set_velocity(joints_.velocity() + change);
  for (int i = 0; i < point_count_; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const Matrix3 to_world = frames_[k].transpose();
    report(points_[k], to_world * cone_.x.segment<3>(3 * i) / spec_.physics_dt,
           to_world * velocity_before_[k]);
  }
}

}  // namespace crossgait::bullet
