// Bounded rows along with contacts, against the conditions that define the solution: of a row between its
// bounds the velocity w is zero, at a bound it points away from it.
#include "backends/contact/bounded_rows.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace crossgait::contact {
namespace {

struct Problem {
  BoundedRows rows{kMaxBoundedRows};
  ConeProblem cones;
  Eigen::MatrixXd whole;  // A of rows, then contacts
  Eigen::VectorXd b;
};

/// @param stiffness  of the rows against the contacts
Problem random_problem(std::mt19937& random, int count, int contacts, double stiffness) {
  std::normal_distribution<double> normal;
  const Eigen::Index n = count + 3 * contacts;
  const auto matrix = [&](Eigen::Index r, Eigen::Index c) {
    return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(r, c, [&] { return normal(random); }));
  };
  Problem problem;
  Eigen::MatrixXd J = matrix(n, 26);
  J.topRows(count) *= stiffness;
  problem.whole = J * J.transpose();
  problem.whole.diagonal().array() += 0.02 * problem.whole.diagonal().array();
  problem.b = matrix(n, 1);
  problem.b.head(count) *= stiffness;
  problem.rows.count = count;
  problem.rows.A.topLeftCorner(count, count) = problem.whole.topLeftCorner(count, count);
  problem.rows.C.topLeftCorner(count, 3 * contacts) = problem.whole.topRightCorner(count, 3 * contacts);
  problem.rows.b.head(count) = problem.b.head(count);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const double bound = 0.1 / stiffness * std::exp(normal(random));
    // Every third one only pushes, as a limit does.
    problem.rows.bounds[i] = i % 3 == 2 ? kOnlyPushes : ImpulseBounds{-bound, bound};
  }
  problem.cones.contacts = contacts;
  problem.cones.friction = 0.6;
  problem.cones.A.topLeftCorner(3 * contacts, 3 * contacts) =
      problem.whole.bottomRightCorner(3 * contacts, 3 * contacts);
  problem.cones.b.head(3 * contacts) = problem.b.tail(3 * contacts);
  return problem;
}

TEST(BoundedRows, KeepTheirConditions) {
  std::mt19937 random(3);
  int between = 0, at_a_bound = 0, most = 0;
  for (int n = 0; n < 600; ++n) {
    const int count = 1 + n % 20, contacts = n % 5;
    const bool coulomb = n % 2 == 1 && contacts < 2;  // many of Coulomb's random contacts have no solution
    Problem p = random_problem(random, count, contacts, n % 3 == 0 ? 30 : 1);
    most = std::max(most, p.rows.solve(p.cones, coulomb, 1e-13, 20000));
    Eigen::VectorXd x(count + 3 * contacts);
    x << p.rows.x.head(count), p.rows.contact_impulses().head(3 * contacts);
    const Eigen::VectorXd w = p.whole * x + p.b;
    const double scale = p.b.head(count).cwiseAbs().maxCoeff();
    for (int i = 0; i < count; ++i) {
      const ImpulseBounds& bounds = p.rows.bounds[static_cast<std::size_t>(i)];
      ASSERT_LE(x[i], bounds.upper);
      ASSERT_GE(x[i], bounds.lower);
      const double kJust = 1e-9 * std::abs(x[i]);
      if (x[i] + kJust < bounds.upper && x[i] - kJust > bounds.lower) {
        ++between;
        ASSERT_NEAR(w[i] / scale, 0, 1e-9) << n << ", row " << i;
      } else {
        ++at_a_bound;
        const double away = x[i] + kJust >= bounds.upper ? -w[i] : w[i];
        ASSERT_GT(away / scale, -1e-9) << n << ", row " << i;
      }
    }
    // The contacts solve what the rows leave: the same problem with the rows' impulses given.
    ConeProblem given = p.cones;
    given.b.head(3 * contacts) += p.whole.bottomLeftCorner(3 * contacts, count) * x.head(count);
    coulomb ? given.solve_coulomb(1e-13, 20000) : given.solve(1e-13, 20000);
    ASSERT_LT((given.x.head(3 * contacts) - x.tail(3 * contacts)).cwiseAbs().sum(), 1e-8) << n;
  }
  std::printf("measured bounded rows: %d between, %d at a bound, at most %d solutions\n", between, at_a_bound,
              most);
  EXPECT_GT(between, 1000);
  EXPECT_GT(at_a_bound, 1000);
  EXPECT_LT(most, BoundedRows::kMostSolutions);  // none had to be swept
}

// A standing robot whose joints and feet are hard has more rows than degrees of freedom.
TEST(BoundedRows, KeepTheirConditionsWithMoreRowsThanDegreesOfFreedom) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  int swept = 0;
  for (int n = 0; n < 100; ++n) {
    constexpr int kCount = 12, kContacts = 4, kRows = kCount + 3 * kContacts;
    const Eigen::MatrixXd J = Eigen::MatrixXd::NullaryExpr(kRows, 18, [&] { return normal(random); });
    const Eigen::MatrixXd A = J * J.transpose();
    const Eigen::VectorXd b = J * Eigen::VectorXd::NullaryExpr(18, [&] { return normal(random); });
    BoundedRows rows(kCount);
    ConeProblem cones;
    rows.count = kCount;
    rows.A.topLeftCorner(kCount, kCount) = A.topLeftCorner(kCount, kCount);
    rows.C.topLeftCorner(kCount, 3 * kContacts) = A.topRightCorner(kCount, 3 * kContacts);
    rows.b.head(kCount) = b.head(kCount);
    std::fill_n(rows.bounds.begin(), kCount, ImpulseBounds{-0.2, 0.2});
    cones.contacts = kContacts;
    cones.friction = 0.6;
    cones.A.topLeftCorner(3 * kContacts, 3 * kContacts) = A.bottomRightCorner(3 * kContacts, 3 * kContacts);
    cones.b.head(3 * kContacts) = b.tail(3 * kContacts);
    if (rows.solve(cones, true, 1e-13, 200000) == BoundedRows::kMostSolutions) ++swept;
    Eigen::VectorXd x(kRows);
    x << rows.x.head(kCount), rows.contact_impulses().head(3 * kContacts);
    const Eigen::VectorXd w = A * x + b;
    for (int i = 0; i < kCount; ++i) {
      const double next = std::clamp(x[i] - w[i] / A(i, i), -0.2, 0.2);
      ASSERT_NEAR(next, x[i], 1e-8) << n << ", row " << i;
    }
    for (int i = kCount; i < kRows; i += 3)
      ASSERT_NEAR(std::max(0.0, x[i] - w[i] / A(i, i)), x[i], 1e-8) << n << ", row " << i;
  }
  std::printf("measured bounded rows: %d of 100 singular problems were swept\n", swept);
}

TEST(BoundedRows, OneAloneIsTheHuberLaw) {
  BoundedRows row(1);
  ConeProblem none;
  row.count = 1;
  row.A(0, 0) = 2;
  row.bounds[0] = {-0.5, 0.5};
  for (const auto& [b, x] :
       {std::pair{0.0, 0.0}, {0.4, -0.2}, {-0.9, 0.45}, {1.0, -0.5}, {7.0, -0.5}, {-7.0, 0.5}}) {
    row.b[0] = b;
    row.solve(none, false, 1e-12, 100);
    EXPECT_NEAR(row.x[0], x, 1e-15);
  }
  row.bounds[0] = kOnlyPushes;
  for (const auto& [b, x] : {std::pair{1.0, 0.0}, {0.0, 0.0}, {-0.9, 0.45}, {-7.0, 3.5}}) {
    row.b[0] = b;
    row.solve(none, false, 1e-12, 100);
    EXPECT_NEAR(row.x[0], x, 1e-15);
  }
}

}  // namespace
}  // namespace crossgait::contact
