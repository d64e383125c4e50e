// What loops make of an inertia, for tests of problems that are given it.
#pragma once

#include <numeric>
#include <vector>

#include "backends/contact/sparse_symmetric.h"

namespace crossgait::contact {

/// Returns 1 + E E', not factored. @param E  dofs x rows, whose products lie within the pattern of `coupled`
inline SparseSymmetric loop_inertia(const std::vector<std::vector<int>>& coupled, const Eigen::MatrixXd& E) {
  const auto dofs = static_cast<int>(E.rows());
  std::vector<int> all(static_cast<std::size_t>(dofs));
  std::iota(all.begin(), all.end(), 0);
  SparseSymmetric inertia(dofs, coupled);
  inertia.set_identity();
  for (Eigen::Index k = 0; k < E.cols(); ++k) {
    PointJacobian row = PointJacobian::Zero(3, dofs);
    row.row(0) = E.col(k).transpose();
    inertia.add_products(all, row);
  }
  return inertia;
}

}  // namespace crossgait::contact
