// The primal problem against the conditions that define its solution, and against the dual's sweeps.
#include "backends/contact/primal_problem.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "backends/contact/cone_solver.h"
#include "tests/backends/contact/loop_inertia.h"

namespace crossgait::contact {
namespace {

constexpr int kDofs = 20;

/// What is given to the solver, kept to look at what comes back.
struct Case {
  double friction = 0.6;
  Eigen::MatrixXd loops = Eigen::MatrixXd::Zero(kDofs, 0);
  struct Contact {
    PointJacobian Z = PointJacobian::Zero(3, kDofs);
    Vector3 R = Vector3::Ones(), b = Vector3::Zero();
  };
  struct Bounded {
    DofVector z = DofVector::Zero(kDofs);
    double R = 1, b = 0;
    ImpulseBounds bounds{-1, 1};
  };
  std::vector<Contact> contacts;
  std::vector<Bounded> bounded;
};

struct Solution {
  int iterations = 0;
  DofVector u;
  std::vector<Vector3> x;  // by contact
  std::vector<double> bounded;
};

const std::vector<int>& all_dofs() {
  static const std::vector<int> kAll = [] {
    std::vector<int> dofs(kDofs);
    std::iota(dofs.begin(), dofs.end(), 0);
    return dofs;
  }();
  return kAll;
}

Solution solve(const Case& c, const DofVector& guess = DofVector::Zero(kDofs)) {
  PrimalProblem problem(kDofs, {all_dofs()}, c.friction);
  const SparseSymmetric inertia = loop_inertia({all_dofs()}, c.loops);
  problem.begin(inertia, c.loops);
  for (const Case::Contact& contact : c.contacts)
    problem.add_contact(all_dofs(), contact.Z, contact.R, contact.b);
  for (const Case::Bounded& row : c.bounded) problem.add_bounded(all_dofs(), row.z, row.R, row.b, row.bounds);
  Solution solution;
  solution.iterations = problem.solve(guess, 1e-15);
  solution.u = problem.u();
  for (std::size_t i = 0; i < c.contacts.size(); ++i)
    solution.x.push_back(problem.contact_impulse(static_cast<int>(i)));
  for (std::size_t i = 0; i < c.bounded.size(); ++i)
    solution.bounded.push_back(problem.bounded_impulse(static_cast<int>(i)));
  return solution;
}

class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}
  double normal() { return normal_(random_); }
  Eigen::MatrixXd matrix(Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [this] { return normal(); });
  }
  Case::Contact contact() {
    Case::Contact c;
    c.Z = matrix(3, kDofs);
    c.b = matrix(3, 1);
    c.b[0] -= 0.5;  // more towards the ground than away from it
    // As soft as a contact's own inertia, or a ten thousandth of that; friction stiffer.
    c.R[0] = std::pow(10.0, -2 + 2 * std::tanh(normal())) * kDofs;
    c.R[1] = c.R[2] = c.R[0] * std::pow(10.0, -std::abs(normal()));
    return c;
  }
  Case::Bounded bounded() {
    Case::Bounded row;
    row.z = matrix(kDofs, 1);
    row.R = 0.1 * kDofs * std::exp(normal());
    row.b = normal();
    const double bound = 0.05 * std::exp(normal());
    // A third of them only push, as a limit does.
    row.bounds = ++bounded_ % 3 == 0 ? kOnlyPushes : ImpulseBounds{-bound, bound};
    return row;
  }
  Case problem(int contacts, int bounded, int loops) {
    Case c;
    c.friction = std::exp(normal() - 0.5);
    c.loops = matrix(kDofs, loops);
    for (int i = 0; i < contacts; ++i) c.contacts.push_back(contact());
    for (int i = 0; i < bounded; ++i) c.bounded.push_back(this->bounded());
    return c;
  }

 private:
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  int bounded_ = 0;
};

struct Counts {
  int apart = 0, stick = 0, slip = 0, between = 0, at_bound = 0, most_iterations = 0;
};

// Of a minimum: impulses within their bounds; velocities that the rows leave over (w = Z u + b + R x) in the
// dual cone, and perpendicular to the impulses; and momentum in balance. All in units of R^(1/2), in which
// they are of one size, and of the largest of them: rounding, times the condition number of some 1e4.
void expect_solved(const Case& c, const Solution& s, Counts& counts) {
  constexpr double kRounding = 1e-10;
  counts.most_iterations = std::max(counts.most_iterations, s.iterations);
  DofVector momentum = s.u + c.loops * (c.loops.transpose() * s.u);
  double size = 1;
  for (const Case::Contact& contact : c.contacts)
    size = std::max(size, contact.b.cwiseQuotient(contact.R.cwiseSqrt()).norm());
  double force = 1;
  for (std::size_t i = 0; i < c.contacts.size(); ++i) {
    const Case::Contact& contact = c.contacts[i];
    const Vector3 root = contact.R.cwiseSqrt(), x = s.x[i];
    const Vector3 w = contact.Z * s.u + contact.b + contact.R.cwiseProduct(x);
    const double tangent = std::hypot(x[1], x[2]), slip = std::hypot(w[1], w[2]);
    momentum -= contact.Z.transpose() * x;
    force = std::max(force, (contact.Z.transpose() * x).norm());
    ASSERT_TRUE(x.allFinite());
    ASSERT_GE(x[0], 0);
    ASSERT_LE(tangent, c.friction * x[0] * (1 + 1e-12));
    ASSERT_GE((w[0] - c.friction * slip) / root[0], -kRounding * size);
    ASSERT_NEAR(w.dot(x), 0, kRounding * size * size);
    if (x[0] == 0) {
      ++counts.apart;
    } else {
      ++(tangent < c.friction * x[0] * (1 - 1e-9) ? counts.stick : counts.slip);
    }
  }
  for (std::size_t i = 0; i < c.bounded.size(); ++i) {
    const Case::Bounded& row = c.bounded[i];
    const double x = s.bounded[i], w = row.z.dot(s.u) + row.b + row.R * x;
    momentum -= row.z * x;
    force = std::max(force, (row.z * x).norm());
    ASSERT_LE(x, row.bounds.upper * (1 + 1e-15));
    ASSERT_GE(x, row.bounds.lower * (1 + 1e-15));
    const double just = 1e-12 * std::abs(x);
    if (x + just < row.bounds.upper && x - just > row.bounds.lower) {
      ++counts.between;
      ASSERT_NEAR(w, 0, kRounding * size);
    } else {
      ++counts.at_bound;
      ASSERT_GE(x + just >= row.bounds.upper ? -w : w, -kRounding * size);
    }
  }
  ASSERT_LT(momentum.norm(), kRounding * force);
}

TEST(PrimalProblem, MeetsTheConditionsOfAMinimum) {
  Draw draw(1);
  Counts counts;
  for (int n = 0; n < 600; ++n) {
    SCOPED_TRACE(n);
    const Case c = draw.problem(n % 40 == 39 ? kMaxContacts : n % 12, n % 3 == 0 ? n % 21 : 0, n % 4 * 3);
    expect_solved(c, solve(c), counts);
    if (HasFailure()) return;
  }
  std::printf(
      "measured primal problem: %d apart, %d stick, %d slip, %d between, %d at a bound, at most %d "
      "iterations\n",
      counts.apart, counts.stick, counts.slip, counts.between, counts.at_bound, counts.most_iterations);
  for (const int count : {counts.apart, counts.stick, counts.slip, counts.between, counts.at_bound})
    EXPECT_GT(count, 300);
  EXPECT_LT(counts.most_iterations, 40);  // of 100
}

TEST(PrimalProblem, TheGuessChangesTheWayAndNotTheEnd) {
  Draw draw(2);
  for (int n = 0; n < 50; ++n) {
    const Case c = draw.problem(1 + n % 8, n % 3, 3);
    const Solution a = solve(c), b = solve(c, 10 * DofVector(draw.matrix(kDofs, 1))), again = solve(c, a.u);
    EXPECT_LT((a.u - b.u).norm(), 1e-12 * (1 + a.u.norm())) << n;
    EXPECT_LT((a.u - again.u).norm(), 1e-12 * (1 + a.u.norm())) << n;
    EXPECT_LE(again.iterations, 3) << n;  // until rounding shrinks no more
  }
}

TEST(PrimalProblem, BeginsAtTheGuessIfThatIsBetterThanNothing) {
  // A guess that has the contacts right and goes too far along a row at its bound, where the cost is half the
  // square of the velocity, less bound times velocity: better than nothing up to twice the solution.
  Draw draw(4);
  for (int n = 0; n < 20; ++n) {
    Case c = draw.problem(6, 0, 0);
    for (Case::Contact& contact : c.contacts) contact.Z.col(0).setZero();
    Case::Bounded row;
    row.z[0] = 1;
    row.b = -1e6;
    row.bounds = {-1000, 1000};
    c.bounded.push_back(row);
    const Solution from_nothing = solve(c);
    ASSERT_NEAR(from_nothing.u[0], 1000, 1e-9) << n;
    DofVector guess = from_nothing.u;
    guess[0] *= 1.8;
    EXPECT_LE(solve(c, guess).iterations, 2) << n;
    guess[0] = 2200;
    EXPECT_EQ(solve(c, guess).iterations, from_nothing.iterations) << n;
    EXPECT_GT(from_nothing.iterations, 2) << n;
  }
}

// The same contacts as a problem in impulses: A = Z (1 + E E')^-1 Z' + R.
TEST(PrimalProblem, IsTheDualOfTheConeProblem) {
  Draw draw(3);
  int compared = 0;
  for (int n = 0; n < 200; ++n) {
    const int contacts = 1 + n % 5, rows = 3 * contacts;
    const Case c = draw.problem(contacts, 0, n % 3 * 3);
    const Eigen::MatrixXd W = Eigen::MatrixXd::Identity(kDofs, kDofs) + c.loops * c.loops.transpose();
    Eigen::MatrixXd Z(rows, kDofs);
    ConeProblem dual;
    dual.contacts = contacts;
    dual.friction = c.friction;
    Eigen::VectorXd R(rows);
    for (int i = 0; i < contacts; ++i) {
      const Case::Contact& contact = c.contacts[static_cast<std::size_t>(i)];
      Z.middleRows(3 * i, 3) = contact.Z;
      R.segment<3>(3 * i) = contact.R;
      dual.b.segment<3>(3 * i) = contact.b;
    }
    dual.A.topLeftCorner(rows, rows) = Z * W.inverse() * Z.transpose();
    dual.A.topLeftCorner(rows, rows).diagonal() += R;
    if (dual.solve(1e-14, 20000) == 20000) continue;
    ++compared;
    const Solution primal = solve(c);
    const double size = dual.x.head(rows).norm();
    for (int i = 0; i < contacts; ++i) {
      EXPECT_LT((primal.x[static_cast<std::size_t>(i)] - dual.x.segment<3>(3 * i)).norm(),
                1e-9 * (1e-3 + size))
          << n;
    }
  }
  EXPECT_GT(compared, 150);
}

TEST(PrimalProblem, DegenerateOnes) {
  Draw draw(4);
  Counts counts;
  const Case plain = draw.problem(4, 3, 3);
  std::vector<Case> cases;
  cases.push_back(plain);
  cases.back().contacts.assign(kMaxContacts, plain.contacts[0]);  // one point, 64 times
  cases.push_back(plain);
  cases.back().contacts[1].Z.setZero();  // nothing moves it
  cases.push_back(plain);
  for (Case::Contact& contact : cases.back().contacts) contact.b.setZero();  // the tip of the cone
  cases.push_back(plain);
  for (Case::Contact& contact : cases.back().contacts) contact.b.tail<2>().setZero();
  cases.push_back(plain);
  for (Case::Contact& contact : cases.back().contacts)
    contact.Z.bottomRows<2>().setZero();  // nothing to slip
  cases.push_back(plain);
  for (Case::Contact& contact : cases.back().contacts) contact.Z.row(0) = contact.Z.row(1);
  for (const double friction : {1e-5, 1e3}) {
    cases.push_back(plain);
    cases.back().friction = friction;
  }
  for (const double R : {1e-4, 1e4}) {
    cases.push_back(plain);
    for (Case::Contact& contact : cases.back().contacts) contact.R *= R / contact.R[0];
  }
  cases.push_back(plain);
  cases.back().contacts.clear();  // joints alone
  cases.push_back(plain);
  cases.back().bounded.assign(kMaxBoundedRows, plain.bounded[0]);
  cases.push_back(plain);
  for (Case::Bounded& row : cases.back().bounded) row.b = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    SCOPED_TRACE(i);
    expect_solved(cases[i], solve(cases[i]), counts);
  }
}

TEST(PrimalProblem, NothingToDoIsNothingDone) {
  Case apart = Draw(5).problem(3, 0, 3);
  for (Case::Contact& contact : apart.contacts) contact.b = {10, 0.1, 0.1};
  const Solution s = solve(apart, DofVector::Ones(kDofs));
  EXPECT_EQ(s.u.norm(), 0);
  for (const Vector3& x : s.x) EXPECT_EQ(x.norm(), 0);
}

TEST(PrimalProblem, OneBoundedRowIsTheHuberLaw) {
  Case c;
  c.bounded.push_back({DofVector::Unit(kDofs, 3), 1, 0, {-0.5, 0.5}});
  for (const auto& [b, x] :
       {std::pair{0.0, 0.0}, {0.4, -0.2}, {-0.9, 0.45}, {1.0, -0.5}, {7.0, -0.5}, {-7.0, 0.5}}) {
    c.bounded[0].b = b;
    EXPECT_NEAR(solve(c).bounded[0], x, 1e-15);
  }
  c.bounded[0].bounds = kOnlyPushes;
  for (const auto& [b, x] : {std::pair{1.0, 0.0}, {0.0, 0.0}, {-0.9, 0.45}, {-7.0, 3.5}}) {
    c.bounded[0].b = b;
    EXPECT_NEAR(solve(c).bounded[0], x, 1e-15);
  }
}

}  // namespace
}  // namespace crossgait::contact
