#include "backends/contact/dual_problem.h"

#include <algorithm>

#include "backends/contact/convergence.h"

namespace crossgait::contact {
DualProblem::DualProblem(const JointStage& joints, int most_bounded, FrictionBound bound, double mixing)
    : joints_(joints), mixing_(mixing), bounded_(most_bounded) {
  cone_.bound = bound;
  const Eigen::Index n = joints.inertia().dofs();
  rows_.setZero(n, ConeProblem::kMaxRows);
  projected_.setZero(n, ConeProblem::kMaxRows);
  bounded_rows_.setZero(n, most_bounded);
  projected_bounded_.setZero(n, most_bounded);
  u_.setZero(n);
}

void DualProblem::begin() noexcept { cone_.contacts = bounded_.count = 0; }

void DualProblem::add_contact(std::span<const int> dofs, const PointJacobian& Z, const Vector3& R,
                              const Vector3& b) noexcept {
  const Eigen::Index first = 3 * cone_.contacts++;
  for (int r = 0; r < 3; ++r) {
    const Eigen::Index row = first + r;
    rows_.col(row).setZero();
    for (const int dof : dofs) rows_(dof, row) = Z(r, dof);
    projected_.col(row) = rows_.col(row);
    joints_.project(projected_.col(row));
    cone_.A(row, row) = R[r];
    cone_.b[row] = b[r];
  }
}

void DualProblem::add_bounded(std::span<const int> dofs, const DofVector& z, double R, double b,
                              const ImpulseBounds& bounds) noexcept {
  const Eigen::Index row = bounded_.count++;
  bounded_rows_.col(row).setZero();
  for (const int dof : dofs) bounded_rows_(dof, row) = z[dof];
  projected_bounded_.col(row) = bounded_rows_.col(row);
  joints_.project(projected_bounded_.col(row));
  bounded_.A(row, row) = R;
  bounded_.b[row] = b;
  bounded_.bounds[static_cast<std::size_t>(row)] = bounds;
}

void DualProblem::solve(double friction, bool coulomb, double tolerance) noexcept {
  const double change = std::max(kRoundingFloor, kSweepTolerance * tolerance);
  const Eigen::Index rows = 3 * cone_.contacts, n = bounded_.count;
  for (Eigen::Index c = 0; c < rows; ++c) {
    const double R = cone_.A(c, c);
    cone_.A.col(c).head(rows).noalias() = rows_.leftCols(rows).transpose() * projected_.col(c);
    cone_.A(c, c) += R + mixing_ * cone_.A(c, c);
  }
  cone_.friction = friction;
  if (n > 0) {
    for (Eigen::Index c = 0; c < n; ++c) {
      const double R = bounded_.A(c, c);
      bounded_.A.col(c).head(n).noalias() = bounded_rows_.leftCols(n).transpose() * projected_bounded_.col(c);
      bounded_.A(c, c) += R;
    }
    bounded_.C.topLeftCorner(n, rows).noalias() =
        projected_bounded_.leftCols(n).transpose() * rows_.leftCols(rows);
    bounded_.solve(cone_, coulomb, change, kMaxSweeps);
    cone_.x.head(rows) = bounded_.contact_impulses().head(rows);
  } else if (coulomb) {
    cone_.solve_coulomb(change, kMaxSweeps);
  } else {
    cone_.solve(change, kMaxSweeps);
  }
  u_.noalias() = projected_.leftCols(rows) * cone_.x.head(rows);
  if (n > 0) u_.noalias() += projected_bounded_.leftCols(n) * bounded_.x.head(n);
}

}  // namespace crossgait::contact
