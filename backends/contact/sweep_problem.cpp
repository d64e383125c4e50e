#include "backends/contact/sweep_problem.h"

#include <algorithm>
#include <cmath>

namespace crossgait::contact {

SweepProblem::SweepProblem(int dofs, const std::vector<std::vector<int>>& coupled, double friction,
                           double mixing)
    : friction_(friction),
      mixing_(mixing),
      reach_(static_cast<std::size_t>(dofs)),
      row_(3, dofs),
      Z_(3, (kMaxContacts + kMaxBoundedRows) * dofs),
      w_(DofVector::Zero(dofs)),
      u_(DofVector::Zero(dofs)) {
  const SparseSymmetric pattern(dofs, coupled);
  for (const std::vector<int>& set : coupled) {
    // Those of bodies come first: a loop is no row's.
    if (!set.empty() && reach(set).empty()) reach_[static_cast<std::size_t>(set.back())] = pattern.reach(set);
  }
}

void SweepProblem::begin(const SparseSymmetric* held) noexcept {
  columns_ = contact_count_ = bounded_count_ = 0;
  held_ = held;
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
  if (held_ != nullptr) held_->half_solve_rows(*contact.dofs, row_);
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
  if (held_ != nullptr) held_->half_solve_rows(*row.dofs, row_);
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
  if (held_ != nullptr) held_->finish_solve(u_);
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

// Whether no contact slips; gathers what is then linear.
bool SweepProblem::gather_sticking(double& largest) noexcept {
  constexpr double kInside =
      1 - 1e-9;  // of the cone: a slipping contact's tangents are on its edge to rounding
  sticking_.clear();
  largest = 0;
  const auto velocity = [this](const std::vector<int>& dofs, int first, int lane) {
    double v = 0;
    for (const int dof : dofs) v += Z_(lane, first++) * w_[dof];
    return v;
  };
  for (int i = 0; i < bounded_count_; ++i) {
    Bounded& row = bounded_[static_cast<std::size_t>(i)];
    largest = std::max(largest, std::abs(row.x));
    if (row.x <= row.bounds.lower || row.x >= row.bounds.upper) continue;
    sticking_.add(row.x, *row.dofs, row.first, 0, row.R, row.step,
                  -(row.b + row.R * row.x + velocity(*row.dofs, row.first, 0)));
  }
  for (int i = 0; i < contact_count_; ++i) {
    Contact& contact = contacts_[static_cast<std::size_t>(i)];
    if (contact.x[0] == 0) continue;
    if (friction_ > 0 && contact.x.tail<2>().norm() >= kInside * friction_ * contact.x[0]) return false;
    largest = std::max(largest, contact.x[0]);
    for (int k = 0; k < (friction_ > 0 ? 3 : 1); ++k) {
      sticking_.add(
          contact.x[k], *contact.dofs, contact.first, k, contact.R[k],
          k == 0 ? contact.normal_step : contact.tangent_step,
          -(contact.b[k] + contact.R[k] * contact.x[k] + velocity(*contact.dofs, contact.first, k)));
    }
  }
  return true;
}

int SweepProblem::converge(int max_sweeps, double share) noexcept {
  constexpr int kFirst = 4, kTimes = 4;  // sweeps until which are pushing has shown; then ever more rarely
  constexpr int kSteps = 2;              // for each dof: without rounding one would do
  w_.setZero();
  int count = 0, next = kFirst;
  while (count < max_sweeps) {
    const Change change = sweep_once(true);
    ++count;
    if (change.impulse <= share * change.largest) break;
    if (count < next) continue;
    next = kTimes * count;
    double largest = 0;
    const int most = std::min(max_sweeps - count, kSteps * static_cast<int>(w_.size()));
    if (gather_sticking(largest)) count += sticking_.solve(Z_, w_, most, share * largest);
  }
  finish();
  return count;
}

}  // namespace crossgait::contact
