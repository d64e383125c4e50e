#include "backends/contact/sparse_symmetric.h"

#include <algorithm>
#include <bitset>
#include <cmath>

namespace crossgait::contact {

SparseSymmetric::SparseSymmetric(int size, const std::vector<std::vector<int>>& coupled) : size_(size) {
  std::array<std::bitset<kMaxDofs>, kMaxDofs> pattern;
  for (const std::vector<int>& set : coupled) {
    for (const int row : set) {
      for (const int column : set) {
        if (column < row) pattern[static_cast<std::size_t>(row)].set(static_cast<std::size_t>(column));
      }
    }
  }
  // Eliminating a row couples all that it is coupled to.
  for (int k = size - 1; k >= 0; --k) {
    const auto& own = pattern[static_cast<std::size_t>(k)];
    Row& row = rows_[static_cast<std::size_t>(k)];
    for (int i = 0; i < k; ++i) {
      if (!own[static_cast<std::size_t>(i)]) continue;
      for (const int j : std::span(row.columns.data(), static_cast<std::size_t>(row.count)))
        pattern[static_cast<std::size_t>(i)].set(static_cast<std::size_t>(j));
      row.columns[static_cast<std::size_t>(row.count++)] = i;
    }
  }
}

void SparseSymmetric::set_identity() noexcept {
  for (int k = 0; k < size_; ++k) {
    for (int j = 0; j < k; ++j) at(k, j) = 0;
    at(k, k) = 1;
  }
}

void SparseSymmetric::copy_values(const SparseSymmetric& other) noexcept {
  for (int k = 0; k < size_; ++k) {
    const auto row = other.values_.begin() + k * kMaxDofs;
    std::copy(row, row + k + 1, values_.begin() + k * kMaxDofs);
  }
}

void SparseSymmetric::add_products(std::span<const int> dofs, const PointJacobian& E) noexcept {
  for (std::size_t r = 0; r < dofs.size(); ++r) {
    const Vector3 row = E.col(dofs[r]);
    double* own = &values_[static_cast<std::size_t>(dofs[r] * kMaxDofs)];
    for (std::size_t c = 0; c <= r; ++c) own[dofs[c]] += row.dot(E.col(dofs[c]));
  }
}

void SparseSymmetric::factor() noexcept {
  for (int k = size_ - 1; k >= 0; --k) {
    const Row& row = rows_[static_cast<std::size_t>(k)];
    const double* own = &values_[static_cast<std::size_t>(k * kMaxDofs)];
    const double inverse = 1 / own[k];
    for (int n = 0; n < row.count; ++n) {
      const int i = row.columns[static_cast<std::size_t>(n)];
      const double share = own[i] * inverse;
      double* other = &values_[static_cast<std::size_t>(i * kMaxDofs)];
      for (int m = 0; m <= n; ++m) {
        const int j = row.columns[static_cast<std::size_t>(m)];
        other[j] -= share * own[j];
      }
    }
    for (int n = 0; n < row.count; ++n) at(k, row.columns[static_cast<std::size_t>(n)]) *= inverse;
  }
}

void SparseSymmetric::solve(Eigen::Ref<DofVector> x) const noexcept {
  for (int k = size_ - 1; k >= 0; --k) {
    const Row& row = rows_[static_cast<std::size_t>(k)];
    for (int n = 0; n < row.count; ++n) {
      const int i = row.columns[static_cast<std::size_t>(n)];
      x[i] -= value(k, i) * x[k];
    }
  }
  for (int k = 0; k < size_; ++k) {
    const Row& row = rows_[static_cast<std::size_t>(k)];
    x[k] /= value(k, k);
    for (int n = 0; n < row.count; ++n) {
      const int i = row.columns[static_cast<std::size_t>(n)];
      x[k] -= value(k, i) * x[i];
    }
  }
}

std::vector<int> SparseSymmetric::reach(const std::vector<int>& dofs) const {
  std::bitset<kMaxDofs> reached;
  for (const int dof : dofs) reached.set(static_cast<std::size_t>(dof));
  std::vector<int> result;
  for (int k = size_ - 1; k >= 0; --k) {
    if (!reached[static_cast<std::size_t>(k)]) continue;
    const Row& row = rows_[static_cast<std::size_t>(k)];
    for (int n = 0; n < row.count; ++n)
      reached.set(static_cast<std::size_t>(row.columns[static_cast<std::size_t>(n)]));
    result.push_back(k);
  }
  std::reverse(result.begin(), result.end());
  return result;
}

void SparseSymmetric::half_solve_rows(const std::vector<int>& reach, PointJacobian& J) const noexcept {
  for (auto dof = reach.rbegin(); dof != reach.rend(); ++dof) {
    const int k = *dof;
    const Row& row = rows_[static_cast<std::size_t>(k)];
    const Vector3 column = J.col(k);
    for (int n = 0; n < row.count; ++n) {
      const int i = row.columns[static_cast<std::size_t>(n)];
      J.col(i) -= value(k, i) * column;
    }
    J.col(k) = column / std::sqrt(value(k, k));
  }
}

void SparseSymmetric::finish_solve(DofVector& x) const noexcept {
  for (int k = 0; k < size_; ++k) {
    const Row& row = rows_[static_cast<std::size_t>(k)];
    x[k] /= std::sqrt(value(k, k));
    for (int n = 0; n < row.count; ++n) {
      const int i = row.columns[static_cast<std::size_t>(n)];
      x[k] -= value(k, i) * x[i];
    }
  }
}

}  // namespace crossgait::contact
