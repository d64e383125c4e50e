#include "backends/contact/primal_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace crossgait::contact {

template <int kRows>
PrimalProblemOf<kRows>::PrimalProblemOf(int dofs, const std::vector<std::vector<int>>& coupled,
                                        double friction)
    : friction_(friction),
      Z_(kRows, (kMaxContacts + kMaxBoundedRows) * dofs),
      hessian_(dofs, coupled),
      u_(DofVector::Zero(dofs)),
      gradient_(DofVector::Zero(dofs)),
      d_(DofVector::Zero(dofs)) {
  loops_u_.resize(3 * kMaxDofs);
  loops_d_.resize(3 * kMaxDofs);
}

template <int kRows>
void PrimalProblemOf<kRows>::begin(const SparseSymmetric& inertia, const Eigen::MatrixXd& loops) noexcept {
  columns_ = contact_count_ = bounded_count_ = 0;
  constant_ = &inertia;
  loops_ = &loops;
}

template <int kRows>
void PrimalProblemOf<kRows>::add_contact(std::span<const int> dofs, const RowsJacobian& Z, const Rows& R,
                                         const Rows& b) noexcept {
  Contact& contact = contacts_[static_cast<std::size_t>(contact_count_++)];
  contact.dofs = dofs;
  contact.first = columns_;
  contact.scale = R.cwiseSqrt().cwiseInverse();
  contact.slope = friction_ * contact.scale[0] / contact.scale[1];
  contact.b = contact.scale.cwiseProduct(b);
  for (const int dof : dofs) Z_.col(columns_++) = contact.scale.cwiseProduct(Z.col(dof));
}

template <int kRows>
void PrimalProblemOf<kRows>::add_bounded(std::span<const int> dofs, const DofVector& z, double R, double b,
                                         const ImpulseBounds& bounds) noexcept {
  Bounded& row = bounded_[static_cast<std::size_t>(bounded_count_++)];
  row.dofs = dofs;
  row.first = columns_;
  row.scale = 1 / std::sqrt(R);
  row.bounds = {bounds.lower / row.scale, bounds.upper / row.scale};
  row.b = row.scale * b;
  for (const int dof : dofs) Z_(0, columns_++) = row.scale * z[dof];
}

template <int kRows>
typename PrimalProblemOf<kRows>::Rows PrimalProblemOf<kRows>::contact_impulse(int i) const noexcept {
  const Contact& contact = contacts_[static_cast<std::size_t>(i)];
  return contact.scale.cwiseProduct(contact.x);
}

template <int kRows>
double PrimalProblemOf<kRows>::bounded_impulse(int i) const noexcept {
  const Bounded& row = bounded_[static_cast<std::size_t>(i)];
  return row.scale * row.x;
}

// From row 1 on, in their order: with two tangents the same sum to the last bit as written out.
template <int kRows>
double PrimalProblemOf<kRows>::tangent_of(const Rows& y) noexcept {
  double squares = y[1] * y[1];
  for (int k = 2; k < kRows; ++k) squares += y[k] * y[k];
  return std::sqrt(squares);
}

// The impulse is the point of the cone nearest to -y.
template <int kRows>
typename PrimalProblemOf<kRows>::Rows PrimalProblemOf<kRows>::project(const Contact& contact, const Rows& y,
                                                                      Zone& zone) noexcept {
  const double m = contact.slope, normal = -y[0], tangent = tangent_of(y);
  if (tangent <= m * normal) {
    zone = Zone::kStick;
    return -y;
  }
  if (m * tangent <= -normal) {
    zone = Zone::kApart;
    return Rows::Zero();
  }
  zone = Zone::kSlip;
  const double x = (normal + m * tangent) / (1 + m * m), share = -m * x / tangent;
  Rows impulse = share * y;
  impulse[0] = x;
  return impulse;
}

// How the impulse follows -y: the derivative of `project`.
template <int kRows>
typename PrimalProblemOf<kRows>::Response PrimalProblemOf<kRows>::response(const Contact& contact,
                                                                           const Rows& y,
                                                                           Zone zone) noexcept {
  if (zone == Zone::kStick) return Response::Identity();
  const double m = contact.slope, tangent = tangent_of(y);
  Rows across = -y / tangent;
  across[0] = 0;
  const Rows along = Rows::UnitX() + m * across;
  const double turn = (-y[0] + m * tangent) * m / tangent;
  Response S = along * along.transpose() - turn * across * across.transpose();
  for (int k = 1; k < kRows; ++k) S(k, k) += turn;
  return S / (1 + m * m);
}

// Impulses at u. @returns the cost
template <int kRows>
double PrimalProblemOf<kRows>::evaluate() noexcept {
  const Eigen::Index loops = loops_->cols();
  loops_u_.head(loops).noalias() = loops_->transpose() * u_;
  double cost = (u_.squaredNorm() + loops_u_.head(loops).squaredNorm()) / 2;
  for (int i = 0; i < contact_count_; ++i) {
    Contact& contact = contacts_[static_cast<std::size_t>(i)];
    contact.y = contact.b + product(contact, u_);
    contact.x = project(contact, contact.y, contact.zone);
    cost += contact.x.squaredNorm() / 2;
  }
  for (int i = 0; i < bounded_count_; ++i) {
    Bounded& row = bounded_[static_cast<std::size_t>(i)];
    row.y = row.b + product(row, u_);
    row.x = row.impulse(row.y);
    cost += -row.x * row.y - row.x * row.x / 2;
  }
  return cost;
}

template <int kRows>
typename PrimalProblemOf<kRows>::Rows PrimalProblemOf<kRows>::product(const Contact& contact,
                                                                      const DofVector& v) const noexcept {
  Rows result = Rows::Zero();
  int column = contact.first;
  for (const int dof : contact.dofs) result += v[dof] * Z_.col(column++);
  return result;
}

template <int kRows>
double PrimalProblemOf<kRows>::product(const Bounded& row, const DofVector& v) const noexcept {
  double result = 0;
  int column = row.first;
  for (const int dof : row.dofs) result += v[dof] * Z_(0, column++);
  return result;
}

template <int kRows>
void PrimalProblemOf<kRows>::find_gradient() noexcept {
  gradient_ = u_;
  gradient_.noalias() += *loops_ * loops_u_.head(loops_->cols());
  for (int i = 0; i < contact_count_; ++i) {
    const Contact& contact = contacts_[static_cast<std::size_t>(i)];
    if (contact.zone == Zone::kApart) continue;
    int column = contact.first;
    for (const int dof : contact.dofs) gradient_[dof] -= Z_.col(column++).dot(contact.x);
  }
  for (int i = 0; i < bounded_count_; ++i) {
    const Bounded& row = bounded_[static_cast<std::size_t>(i)];
    int column = row.first;
    for (const int dof : row.dofs) gradient_[dof] -= Z_(0, column++) * row.x;
  }
}

template <int kRows>
void PrimalProblemOf<kRows>::find_hessian() noexcept {
  hessian_.copy_values(*constant_);
  for (int i = 0; i < contact_count_; ++i) {
    const Contact& contact = contacts_[static_cast<std::size_t>(i)];
    if (contact.zone == Zone::kApart) continue;
    const Response S = response(contact, contact.y, contact.zone);
    for (std::size_t r = 0; r < contact.dofs.size(); ++r) {
      const Rows SZ = S * Z_.col(contact.first + static_cast<int>(r));
      for (std::size_t c = 0; c <= r; ++c)
        hessian_.at(contact.dofs[r], contact.dofs[c]) += SZ.dot(Z_.col(contact.first + static_cast<int>(c)));
    }
  }
  for (int i = 0; i < bounded_count_; ++i) {
    const Bounded& row = bounded_[static_cast<std::size_t>(i)];
    if (!row.between(row.y)) continue;
    for (std::size_t r = 0; r < row.dofs.size(); ++r) {
      for (std::size_t c = 0; c <= r; ++c)
        hessian_.at(row.dofs[r], row.dofs[c]) +=
            Z_(0, row.first + static_cast<int>(r)) * Z_(0, row.first + static_cast<int>(c));
    }
  }
}

// Derivatives of the cost along d_.
template <int kRows>
typename PrimalProblemOf<kRows>::Slope PrimalProblemOf<kRows>::slope_at(double a) const noexcept {
  Slope slope{line_.first + a * line_.second, line_.second};
  for (int i = 0; i < contact_count_; ++i) {
    const Contact& contact = contacts_[static_cast<std::size_t>(i)];
    const Rows y = contact.y + a * contact.step;
    Zone zone = Zone::kApart;
    slope.first -= project(contact, y, zone).dot(contact.step);
    if (zone != Zone::kApart) slope.second += contact.step.dot(response(contact, y, zone) * contact.step);
  }
  for (int i = 0; i < bounded_count_; ++i) {
    const Bounded& row = bounded_[static_cast<std::size_t>(i)];
    const double y = row.y + a * row.step;
    slope.first -= row.impulse(y) * row.step;
    if (row.between(y)) slope.second += row.step * row.step;
  }
  return slope;
}

// The lowest point along d_, as a share of it: Newton's method kept inside by bisection. The cost is convex
// and its slope continuous.
template <int kRows>
double PrimalProblemOf<kRows>::search_line() noexcept {
  constexpr double kFlat = 1e-6;  // of the slope at the start: what is left costs no iteration
  const Eigen::Index loops = loops_->cols();
  loops_d_.head(loops).noalias() = loops_->transpose() * d_;
  line_ = {u_.dot(d_) + loops_u_.head(loops).dot(loops_d_.head(loops)),
           d_.squaredNorm() + loops_d_.head(loops).squaredNorm()};
  for (int i = 0; i < contact_count_; ++i) {
    Contact& contact = contacts_[static_cast<std::size_t>(i)];
    contact.step = product(contact, d_);
  }
  for (int i = 0; i < bounded_count_; ++i) {
    Bounded& row = bounded_[static_cast<std::size_t>(i)];
    row.step = product(row, d_);
  }
  const double start = std::abs(gradient_.dot(d_));
  double low = 0, high = std::numeric_limits<double>::infinity(), a = 1;
  for (int i = 0; i < 50; ++i) {
    const Slope slope = slope_at(a);
    if (std::abs(slope.first) <= kFlat * start) break;
    (slope.first < 0 ? low : high) = a;
    a -= slope.first / slope.second;
    if (!(a > low && a < high)) a = std::isfinite(high) ? (low + high) / 2 : 2 * low;
  }
  return a;
}

template <int kRows>
int PrimalProblemOf<kRows>::solve(const DofVector& guess, double tolerance) noexcept {
  // Below this share the gradient may be rounding, and then shrinks no more.
  constexpr double kMayBeRounding = 1e-9;
  u_.setZero();
  const double at_zero = evaluate();
  u_ = guess;
  if (!(evaluate() < at_zero)) {
    u_.setZero();
    evaluate();
  }
  double last = std::numeric_limits<double>::infinity();
  for (int i = 0;; ++i) {
    find_gradient();
    const double length = gradient_.norm(), size = u_.norm();
    if (length <= tolerance * size || i == kMaxIterations) return i;
    if (length <= kMayBeRounding * size && length > last / 2) return i;
    last = length;
    find_hessian();
    hessian_.factor();
    d_ = -gradient_;
    hessian_.solve(d_);
    u_ += search_line() * d_;
    evaluate();
  }
}

template class PrimalProblemOf<3>;
template class PrimalProblemOf<4>;
template class PrimalProblemOf<6>;

}  // namespace crossgait::contact
