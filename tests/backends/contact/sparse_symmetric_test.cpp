// A matrix of a tree with loops, against a full one.
#include "backends/contact/sparse_symmetric.h"

#include <random>

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace crossgait::contact {
namespace {

TEST(SparseSymmetric, SolvesAsAFullMatrixDoes) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  // A base of three, two legs of four with a branch each, and a loop across the second one's.
  const std::vector<std::vector<int>> coupled{{0, 1, 2, 3, 4},     {0, 1, 2, 3, 5, 6},        {0, 1, 2, 7, 8},
                                              {0, 1, 2, 7, 9, 10}, {0, 1, 2, 7, 8, 9, 10, 7}, {}};
  const std::vector<int> loop{0, 1, 2, 7, 8, 9, 10};
  constexpr int kSize = 11;
  for (int n = 0; n < 20; ++n) {
    SparseSymmetric sparse(kSize, coupled), copy(kSize, coupled);
    Eigen::MatrixXd full = Eigen::MatrixXd::Identity(kSize, kSize);
    PointJacobian E = PointJacobian::Zero(3, kSize);
    for (const int dof : loop) E.col(dof) << normal(random), normal(random), normal(random);
    sparse.set_identity();
    sparse.add_products(loop, E);
    full += E.transpose() * E;
    for (const std::vector<int>& set : coupled) {
      Eigen::VectorXd v = Eigen::VectorXd::Zero(kSize);
      for (const int dof : set) v[dof] = normal(random);
      full += v * v.transpose();
      for (int row = 0; row < kSize; ++row) {
        for (int column = 0; column <= row; ++column) {
          if (v[row] * v[column] != 0) sparse.at(row, column) += v[row] * v[column];
        }
      }
    }
    const DofVector b = Eigen::VectorXd::NullaryExpr(kSize, [&] { return normal(random); });
    const Eigen::VectorXd expected = full.partialPivLu().solve(b);
    copy.copy_values(sparse);
    for (SparseSymmetric* matrix : {&sparse, &copy}) {
      matrix->factor();
      DofVector x = b;
      matrix->solve(x);
      EXPECT_LT((x - expected).norm(), 1e-12 * expected.norm());  // rounding times a condition of 100
    }
    sparse.set_identity();
    sparse.factor();
    DofVector x = b;
    sparse.solve(x);
    EXPECT_EQ((x - b).norm(), 0);
  }
}

}  // namespace
}  // namespace crossgait::contact
