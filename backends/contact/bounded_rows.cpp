#include "backends/contact/bounded_rows.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace crossgait::contact {

BoundedRows::BoundedRows(int most)
    : A(most, most),
      C(most, ConeProblem::kMaxRows),
      b(most),
      x(most),
      L_(most, most),
      LC_(most, ConeProblem::kMaxRows),
      Lb_(most) {}

double BoundedRows::clamp(Eigen::Index row, double impulse) const noexcept {
  const ImpulseBounds& within = bounds[static_cast<std::size_t>(row)];
  return std::clamp(impulse, within.lower, within.upper);
}

double BoundedRows::velocity(Eigen::Index row) const noexcept {
  const Eigen::Index contact_rows = 3 * reduced_.contacts;
  return b[row] + A.col(row).head(count).dot(x.head(count)) +
         C.row(row).head(contact_rows).dot(reduced_.x.head(contact_rows));
}

// On which side a row would be after a step of its own. `tolerance` keeps rows that are just at a bound from
// changing sides for ever.
BoundedRows::Side BoundedRows::side_of(Eigen::Index row, double tolerance) const noexcept {
  const ImpulseBounds& within = bounds[static_cast<std::size_t>(row)];
  const double step = x[row] - velocity(row) / A(row, row);
  const double largest = std::max(within.upper, -within.lower);
  const double slack = tolerance * (std::isfinite(largest) ? largest : std::abs(step));
  const Side now = sides_[static_cast<std::size_t>(row)];
  if (step > within.upper + (now == Side::kUpper ? -slack : slack)) return Side::kUpper;
  if (step < within.lower - (now == Side::kLower ? -slack : slack)) return Side::kLower;
  return Side::kBetween;
}

// @returns whether a row changed sides
bool BoundedRows::pivot(bool all, double tolerance) noexcept {
  bool changed = false;
  std::array<Side, kMaxBoundedRows> next = sides_;
  for (int i = 0; i < count && (all || !changed); ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    next[k] = side_of(i, tolerance);
    changed = changed || next[k] != sides_[k];
  }
  sides_ = next;
  return changed;
}

void BoundedRows::eliminate(const ConeProblem& contacts) noexcept {
  const Eigen::Index rows = 3 * contacts.contacts;
  between_count_ = 0;
  for (int i = 0; i < count; ++i) {
    const Side side = sides_[static_cast<std::size_t>(i)];
    const ImpulseBounds& within = bounds[static_cast<std::size_t>(i)];
    x[i] = side == Side::kUpper ? within.upper : side == Side::kLower ? within.lower : 0;
    if (side == Side::kBetween) between_[static_cast<std::size_t>(between_count_++)] = i;
  }
  const Eigen::Index n = between_count_;
  for (Eigen::Index r = 0; r < n; ++r) {
    const Eigen::Index row = between_[static_cast<std::size_t>(r)];
    for (Eigen::Index c = 0; c < n; ++c) L_(r, c) = A(row, between_[static_cast<std::size_t>(c)]);
    LC_.row(r).head(rows) = C.row(row).head(rows);
    Lb_[r] = b[row] + A.col(row).head(count).dot(x.head(count));
  }
  Eigen::Ref<Eigen::MatrixXd> L = L_.topLeftCorner(n, n);
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> cholesky(L);
  cholesky.matrixL().solveInPlace(LC_.topLeftCorner(n, rows));
  cholesky.matrixL().solveInPlace(Lb_.head(n));

  reduced_.contacts = contacts.contacts;
  reduced_.friction = contacts.friction;
  reduced_.bound = contacts.bound;
  const auto LC = LC_.topLeftCorner(n, rows);
  reduced_.A.topLeftCorner(rows, rows) = contacts.A.topLeftCorner(rows, rows);
  reduced_.A.topLeftCorner(rows, rows).noalias() -= LC.transpose() * LC;
  reduced_.b.head(rows) = contacts.b.head(rows);
  reduced_.b.head(rows).noalias() += C.topLeftCorner(count, rows).transpose() * x.head(count);
  reduced_.b.head(rows).noalias() -= LC.transpose() * Lb_.head(n);
}

// The eliminated rows, from the contacts' impulses.
void BoundedRows::finish(Eigen::Index contact_rows) noexcept {
  const Eigen::Index n = between_count_;
  Lb_.head(n).noalias() += LC_.topLeftCorner(n, contact_rows) * reduced_.x.head(contact_rows);
  L_.topLeftCorner(n, n).triangularView<Eigen::Lower>().transpose().solveInPlace(Lb_.head(n));
  for (Eigen::Index r = 0; r < n; ++r) x[between_[static_cast<std::size_t>(r)]] = -Lb_[r];
}

int BoundedRows::solve(const ConeProblem& contacts, bool coulomb, double tolerance, int max_sweeps) noexcept {
  constexpr int kBlocks = 10;
  x.head(count).setZero();
  reduced_.contacts = 0;  // the first guess is without the contacts
  sides_.fill(Side::kBetween);
  pivot(true, 0);
  for (int solution = 1;; ++solution) {
    eliminate(contacts);
    if (coulomb) {
      reduced_.solve_coulomb(tolerance, max_sweeps);
    } else {
      reduced_.solve(tolerance, max_sweeps);
    }
    finish(3 * contacts.contacts);
    if (!pivot(solution <= kBlocks, 10 * tolerance)) {
      for (Eigen::Index row = 0; row < count; ++row) x[row] = clamp(row, x[row]);
      return solution;
    }
    if (solution == kMostSolutions) {
      sweep(contacts, coulomb, tolerance, max_sweeps);
      return solution;
    }
  }
}

// Projected Gauss-Seidel from zero, rows first, as Bullet does it.
void BoundedRows::sweep(const ConeProblem& contacts, bool coulomb, double tolerance,
                        int max_sweeps) noexcept {
  const Eigen::Index contact_rows = 3 * contacts.contacts;
  reduced_.A.topLeftCorner(contact_rows, contact_rows) = contacts.A.topLeftCorner(contact_rows, contact_rows);
  reduced_.x.head(contact_rows).setZero();
  x.head(count).setZero();
  for (int i = 0; i < max_sweeps; ++i) {
    double change = 0, largest = 0;
    for (Eigen::Index row = 0; row < count; ++row) {
      const double old = x[row];
      x[row] = clamp(row, old - velocity(row) / A(row, row));
      change = std::max(change, std::abs(x[row] - old));
      largest = std::max(largest, std::abs(x[row]));
    }
    reduced_.b.head(contact_rows) = contacts.b.head(contact_rows);
    reduced_.b.head(contact_rows).noalias() +=
        C.topLeftCorner(count, contact_rows).transpose() * x.head(count);
    if (coulomb) reduced_.begin_coulomb(tolerance, max_sweeps);
    const ConeProblem::Sweep swept = coulomb ? reduced_.sweep_coulomb() : reduced_.sweep();
    if (std::max(change, swept.change) <= tolerance * std::max(largest, swept.largest)) return;
  }
}

}  // namespace crossgait::contact
