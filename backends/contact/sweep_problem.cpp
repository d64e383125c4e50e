#include "backends/contact/sweep_problem.h"

#include <algorithm>
#include <cmath>

namespace crossgait::contact {

SweepProblem::SweepProblem(int dofs, const std::vector<std::vector<int>>& coupled, double friction,
                           double mixing)
    : friction_(friction),
      mixing_(mixing),
      loops_(dofs, coupled),
      reach_(static_cast<std::size_t>(dofs)),
      row_(3, dofs),
      Z_(3, (kMaxContacts + kMaxBoundedRows) * dofs),
      w_(DofVector::Zero(dofs)),
      u_(DofVector::Zero(dofs)) {
  for (const std::vector<int>& set : coupled) {
    if (set.empty() || !std::is_sorted(set.begin(), set.end())) continue;  // of a loop, not of a body
    reach_[static_cast<std::size_t>(set.back())] = loops_.reach(set);
  }
}

void SweepProblem::begin(const Eigen::MatrixXd& loops) noexcept {
  columns_ = contact_count_ = bounded_count_ = 0;
  has_loops_ = loops.cols() > 0;
  if (!has_loops_) return;
  loops_.set_identity();
  loops_.add_products(loops);
  loops_.factor();
}

const std::vector<int>& SweepProblem::reach(std::span<const int> dofs) const noexcept {
  static const std::vector<int> kNone;
  return dofs.empty() ? kNone : reach_[static_cast<std::size_t>(dofs.back())];
}

void SweepProblem::add_contact(std::span<const int> dofs, const PointJacobian& Z, const Vector3& R,
                               const Vector3& b) noexcept {
  Contact& contact = contacts_[static_cast<std::size_t>(contact_count_++)];
  contact.dofs = &reach(dofs);
  contact.first = columns_;
  contact.b = b;
  contact.x.setZero();
  for (const int dof : *contact.dofs) row_.col(dof).setZero();
  for (const int dof : dofs) row_.col(dof) = Z.col(dof);
  if (has_loops_) loops_.half_solve_rows(*contact.dofs, row_);
  Vector3 A = R;
  for (const int dof : *contact.dofs) {
    A += row_.col(dof).cwiseAbs2();
    Z_.col(columns_++) = row_.col(dof);
  }
  const Vector3 mixed = mixing_ * (A - R);
  contact.R = R + mixed;
  A += mixed;
  contact.normal_step = A[0] > 0 ? 1 / A[0] : 0;
  // One step size for both directions, or friction would not oppose slip.
  const double across = std::max(A[1], A[2]);
  contact.tangent_step = across > 0 ? 1 / across : 0;
}

void SweepProblem::add_bounded(std::span<const int> dofs, const DofVector& z, double R, double b,
                               const ImpulseBounds& bounds) noexcept {
  Bounded& row = bounded_[static_cast<std::size_t>(bounded_count_++)];
  row = {&reach(dofs), columns_, R, b, bounds, 0, 0};
  for (const int dof : *row.dofs) row_.col(dof).setZero();
  for (const int dof : dofs) row_(0, dof) = z[dof];
  if (has_loops_) loops_.half_solve_rows(*row.dofs, row_);
  double A = R;
  for (const int dof : *row.dofs) {
    A += row_(0, dof) * row_(0, dof);
    Z_.col(columns_++) = row_.col(dof);
  }
  row.step = A > 0 ? 1 / A : 0;
}

void SweepProblem::sweep_bounded(bool forward, Change& change) noexcept {
  for (int i = 0; i < bounded_count_; ++i) {
    Bounded& row = bounded_[static_cast<std::size_t>(forward ? i : bounded_count_ - 1 - i)];
    double velocity = row.b + row.R * row.x;
    int column = row.first;
    for (const int dof : *row.dofs) velocity += Z_(0, column++) * w_[dof];
    const double next = std::clamp(row.x - row.step * velocity, row.bounds.lower, row.bounds.upper);
    const double by = next - row.x;
    row.x = next;
    change.largest = std::max(change.largest, std::abs(next));
    if (by == 0) continue;
    column = row.first;
    for (const int dof : *row.dofs) w_[dof] += by * Z_(0, column++);
    change.impulse = std::max(change.impulse, std::abs(by));
    change.velocity = std::max(change.velocity, std::abs(by) / row.step);
  }
}

void SweepProblem::sweep_normals(Change& change) noexcept {
  for (int i = 0; i < contact_count_; ++i) {
    Contact& contact = contacts_[static_cast<std::size_t>(i)];
    double velocity = contact.b[0] + contact.R[0] * contact.x[0];
    int column = contact.first;
    for (const int dof : *contact.dofs) velocity += Z_(0, column++) * w_[dof];
    const double next = std::max(0.0, contact.x[0] - contact.normal_step * velocity);
    const double by = next - contact.x[0];
    contact.x[0] = next;
    change.largest = std::max(change.largest, next);
    if (by == 0) continue;
    column = contact.first;
    for (const int dof : *contact.dofs) w_[dof] += by * Z_(0, column++);
    change.impulse = std::max(change.impulse, std::abs(by));
    change.velocity = std::max(change.velocity, std::abs(by) / contact.normal_step);
  }
}

void SweepProblem::sweep_tangents(Change& change) noexcept {
  for (int i = 0; i < contact_count_; ++i) {
    Contact& contact = contacts_[static_cast<std::size_t>(i)];
    const double limit = friction_ * contact.x[0];
    if (limit == 0 && contact.x[1] == 0 && contact.x[2] == 0) continue;
    double v1 = contact.b[1] + contact.R[1] * contact.x[1], v2 = contact.b[2] + contact.R[2] * contact.x[2];
    int column = contact.first;
    for (const int dof : *contact.dofs) {
      v1 += Z_(1, column) * w_[dof];
      v2 += Z_(2, column++) * w_[dof];
    }
    double x1 = contact.x[1] - contact.tangent_step * v1, x2 = contact.x[2] - contact.tangent_step * v2;
    const double squared = x1 * x1 + x2 * x2;
    if (squared > limit * limit) {
      const double scale = limit / std::sqrt(squared);
      x1 *= scale;
      x2 *= scale;
    }
    const double by1 = x1 - contact.x[1], by2 = x2 - contact.x[2];
    contact.x[1] = x1;
    contact.x[2] = x2;
    column = contact.first;
    for (const int dof : *contact.dofs) {
      w_[dof] += by1 * Z_(1, column) + by2 * Z_(2, column);
      ++column;
    }
    change.impulse = std::max({change.impulse, std::abs(by1), std::abs(by2)});
    if (contact.tangent_step > 0)
      change.velocity = std::max(change.velocity, std::abs(by1 + by2) / contact.tangent_step);
  }
}

SweepProblem::Change SweepProblem::sweep_once(bool bounded_forward) noexcept {
  Change change;
  sweep_bounded(bounded_forward, change);
  sweep_normals(change);
  sweep_tangents(change);
  return change;
}

void SweepProblem::finish() noexcept {
  u_ = w_;
  if (has_loops_) loops_.finish_solve(u_);
}

int SweepProblem::sweep(int max_sweeps, double enough) noexcept {
  w_.setZero();
  int count = 0;
  while (count < max_sweeps) {
    const bool forward = count % 2 == 1;
    ++count;
    if (sweep_once(forward).velocity <= enough) break;
  }
  finish();
  return count;
}

int SweepProblem::converge(int max_sweeps, double share) noexcept {
  w_.setZero();
  int count = 0;
  while (count < max_sweeps) {
    const Change change = sweep_once(true);
    ++count;
    if (change.impulse <= share * change.largest) break;
  }
  finish();
  return count;
}

}  // namespace crossgait::contact
