// A symmetric positive definite matrix over degrees of freedom, most of whose entries are zero by the
// robot's structure.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "backends/contact/joint_space_inertia.h"

namespace crossgait::contact {

/// Factors a matrix as L^T D L from the last degree of freedom to the first (children before parents), over
/// the entries alone that can be other than zero. Legs fill in towards the base and not each other: a robot
/// of four legs of five joints takes a quarter of the work of a full matrix, one of 32 legs a tenth.
class SparseSymmetric {
 public:
  /// @param size     up to kMaxDofs
  /// @param coupled  sets of dofs, any two of which of one set may have an entry
  SparseSymmetric(int size, const std::vector<std::vector<int>>& coupled);

  void set_identity() noexcept;
  /// Copies a matrix of the same size and pattern.
  void copy_values(const SparseSymmetric& other) noexcept;
  /// Adds E' E, whose entries lie within the pattern.
  /// @param dofs  rising  @param E  3 x size, of which those columns alone are read
  void add_products(std::span<const int> dofs, const PointJacobian& E) noexcept;
  /// Returns an entry, row >= column.
  double& at(int row, int column) noexcept {
    return values_[static_cast<std::size_t>(row * kMaxDofs + column)];
  }
  /// Factors in place: `set_identity` or `copy_values` begins anew.
  void factor() noexcept;
  /// Solves x <- A^-1 x, after `factor`.
  void solve(Eigen::Ref<DofVector> x) const noexcept;

  /// Lists the dofs that `half_solve_rows` reaches from these, rising.
  std::vector<int> reach(const std::vector<int>& dofs) const;
  /// Computes J <- J L^-1 D^-1/2 for three rows that are zero but in `reach`; after `factor`.
  void half_solve_rows(const std::vector<int>& reach, PointJacobian& J) const noexcept;
  /// Computes x <- L^-1 D^-1/2 x.
  void finish_solve(DofVector& x) const noexcept;

 private:
  double value(int row, int column) const noexcept {
    return values_[static_cast<std::size_t>(row * kMaxDofs + column)];
  }

  struct Row {
    std::array<int, kMaxDofs> columns;  // below the diagonal, rising; those that fill in as well
    int count = 0;
  };
  int size_;
  std::array<Row, kMaxDofs> rows_;
  std::array<double, kMaxDofs * kMaxDofs> values_{};
};

}  // namespace crossgait::contact
