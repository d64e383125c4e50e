// Sweeps over velocities against the law that they are to solve, and against sweeps over impulses.
#include "backends/contact/sweep_problem.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <span>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "backends/contact/cone_solver.h"
#include "tests/backends/contact/loop_inertia.h"

namespace crossgait::contact {
namespace {

/// A base of three and two legs of four with a loop across each, as dofs.
struct Machine {
  static constexpr int kDofs = 11;
  const std::vector<std::vector<int>> bodies{
      {0, 1, 2}, {0, 1, 2, 3, 4}, {0, 1, 2, 3, 5, 6}, {0, 1, 2, 7, 8, 9}, {0, 1, 2, 7, 10}};
  std::vector<std::vector<int>> coupled = bodies;
  Machine() {
    coupled.push_back({0, 1, 2, 3, 4, 5, 6});
    coupled.push_back({0, 1, 2, 7, 8, 9, 10});
  }
};

struct Drawn {
  std::unique_ptr<SparseSymmetric> held;  // 1 + loops loops', factored
  Eigen::MatrixXd loops, Z;               // dofs x loops; 3 contacts, then bounded rows, x dofs
  Eigen::VectorXd R, b;
  std::vector<ImpulseBounds> bounds;  // of all rows; not used of contacts
  int contacts = 0;

  Eigen::MatrixXd A() const {
    const Eigen::MatrixXd W =
        Eigen::MatrixXd::Identity(Machine::kDofs, Machine::kDofs) + loops * loops.transpose();
    Eigen::MatrixXd result = Z * W.inverse() * Z.transpose();
    result.diagonal() += R;
    return result;
  }
};

/// Fills `problem` and says what with.
Drawn draw(const Machine& machine, std::mt19937& random, int contacts, int bounded, int loops, double R,
           SweepProblem& problem) {
  std::normal_distribution<double> normal;
  Drawn drawn;
  drawn.contacts = contacts;
  drawn.loops = Eigen::MatrixXd::Zero(Machine::kDofs, loops);
  for (int k = 0; k < loops; ++k) {
    for (const int dof : machine.coupled[5 + static_cast<std::size_t>(k % 2)])
      drawn.loops(dof, k) = normal(random);
  }
  drawn.held = std::make_unique<SparseSymmetric>(loop_inertia(machine.coupled, drawn.loops));
  drawn.held->factor();
  problem.begin(loops > 0 ? drawn.held.get() : nullptr);
  const int rows = 3 * contacts + bounded;
  drawn.Z = Eigen::MatrixXd::Zero(rows, Machine::kDofs);
  drawn.R = Eigen::VectorXd::Constant(rows, R);
  drawn.b = Eigen::VectorXd::NullaryExpr(rows, [&] { return normal(random); });
  for (int row = 0; row < rows; ++row) {
    const double bound = 0.3 * std::exp(normal(random));
    // Every third one only pushes, as a limit does.
    drawn.bounds.push_back(row % 3 == 2 ? kOnlyPushes : ImpulseBounds{-bound, bound});
  }
  for (int row = 0; row < rows; ++row) {
    const int body = row < 3 * contacts ? row / 3 : row;
    for (const int dof : machine.bodies[static_cast<std::size_t>(body) % 5])
      drawn.Z(row, dof) = normal(random);
  }
  for (int i = 0; i < contacts; ++i) {
    const PointJacobian Z = drawn.Z.middleRows(3 * i, 3);
    problem.add_contact(machine.bodies[static_cast<std::size_t>(i) % 5], Z, drawn.R.segment<3>(3 * i),
                        drawn.b.segment<3>(3 * i));
  }
  for (int row = 3 * contacts; row < rows; ++row) {
    problem.add_bounded(machine.bodies[static_cast<std::size_t>(row) % 5], drawn.Z.row(row).transpose(),
                        drawn.R[row], drawn.b[row], drawn.bounds[static_cast<std::size_t>(row)]);
  }
  return drawn;
}

Eigen::VectorXd impulses(const SweepProblem& problem, const Drawn& drawn) {
  Eigen::VectorXd x(drawn.b.size());
  for (int i = 0; i < drawn.contacts; ++i) x.segment<3>(3 * i) = problem.contact_impulse(i);
  for (Eigen::Index row = 3 * drawn.contacts; row < x.size(); ++row)
    x[row] = problem.bounded_impulse(static_cast<int>(row) - 3 * drawn.contacts);
  return x;
}

// Row by row, for random contacts and joints that see each other.
TEST(SweepProblem, SatisfiesTheLawItStates) {
  const Machine machine;
  std::mt19937 random(1);
  constexpr double kFriction = 0.5;
  SweepProblem problem(Machine::kDofs, machine.coupled, kFriction, 0);
  int sticking = 0, sliding = 0, apart = 0, between = 0, at_bound = 0;
  for (int n = 0; n < 600; ++n) {
    const int contacts = n % 5 == 4 ? 9 + n % 4 : 1 + n % 3;
    const Drawn drawn = draw(machine, random, contacts, n % 4, n % 3 * 3, 3, problem);
    ASSERT_LT(problem.converge(20000, 1e-14), 20000) << n;
    const Eigen::VectorXd x = impulses(problem, drawn), w = drawn.A() * x + drawn.b;
    for (Eigen::Index i = 0; i < 3 * drawn.contacts; i += 3) {
      const Eigen::Vector2d force(x[i + 1], x[i + 2]), slip(w[i + 1], w[i + 2]);
      const double limit = kFriction * x[i];
      ASSERT_GE(x[i], 0);
      ASSERT_GT(w[i], -1e-10);
      ASSERT_NEAR(x[i] * w[i], 0, 1e-10);
      ASSERT_LE(force.norm(), limit + 1e-12);
      if (x[i] == 0) {
        ++apart;
      } else if (slip.norm() > 1e-9) {  // as large as it may be, straight against the slip
        ++sliding;
        ASSERT_NEAR((force + limit * slip / slip.norm()).norm(), 0, 1e-8) << n;
      } else {
        ++sticking;
      }
    }
    for (Eigen::Index i = 3 * drawn.contacts; i < x.size(); ++i) {
      const ImpulseBounds& bounds = drawn.bounds[static_cast<std::size_t>(i)];
      ASSERT_LE(x[i], bounds.upper);
      ASSERT_GE(x[i], bounds.lower);
      if (x[i] < bounds.upper && x[i] > bounds.lower) {
        ++between;
        ASSERT_NEAR(w[i], 0, 1e-10);
      } else {
        ++at_bound;
        ASSERT_GT(x[i] == bounds.upper ? -w[i] : w[i], -1e-10);
      }
    }
    // What it says of the robot's velocity is what these impulses do.
    const Eigen::MatrixXd W =
        Eigen::MatrixXd::Identity(Machine::kDofs, Machine::kDofs) + drawn.loops * drawn.loops.transpose();
    ASSERT_LT((W * problem.u() - drawn.Z.transpose() * x).norm(), 1e-11 * (1 + x.norm())) << n;
  }
  for (const int count : {sticking, sliding, apart, between, at_bound}) EXPECT_GT(count, 50);
}

TEST(SweepProblem, ConvergesToWhatSweepsOverImpulsesDo) {
  const Machine machine;
  std::mt19937 random(2);
  constexpr double kFriction = 0.7;
  SweepProblem problem(Machine::kDofs, machine.coupled, kFriction, 0);
  for (int n = 0; n < 100; ++n) {
    const Drawn drawn = draw(machine, random, 1 + n % 3, 0, n % 3 * 3, 3, problem);
    problem.converge(20000, 1e-14);
    const int rows = 3 * drawn.contacts;
    ConeProblem impulse;
    impulse.contacts = drawn.contacts;
    impulse.friction = kFriction;
    impulse.A.topLeftCorner(rows, rows) = drawn.A();
    impulse.b.head(rows) = drawn.b;
    impulse.solve_coulomb(1e-14, 20000);
    EXPECT_LT((impulses(problem, drawn) - impulse.x.head(rows)).norm(), 1e-10) << n;
  }
}

// Sweeps over impulses, row after row, in the order that SweepProblem states.
Eigen::VectorXd swept_impulses(const Drawn& drawn, double friction, int sweeps) {
  const Eigen::MatrixXd A = drawn.A();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(A.rows());
  const auto velocity = [&](Eigen::Index row) { return A.row(row).dot(x) + drawn.b[row]; };
  const Eigen::Index normals_end = 3 * drawn.contacts, rows = A.rows();
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (Eigen::Index k = normals_end; k < rows; ++k) {
      const Eigen::Index row = sweep % 2 == 1 ? k : rows - 1 - (k - normals_end);
      const ImpulseBounds& bounds = drawn.bounds[static_cast<std::size_t>(row)];
      x[row] = std::clamp(x[row] - velocity(row) / A(row, row), bounds.lower, bounds.upper);
    }
    for (Eigen::Index i = 0; i < normals_end; i += 3) x[i] = std::max(0.0, x[i] - velocity(i) / A(i, i));
    for (Eigen::Index i = 0; i < normals_end; i += 3) {
      const double step = 1 / std::max(A(i + 1, i + 1), A(i + 2, i + 2)), limit = friction * x[i];
      Eigen::Vector2d force = x.segment<2>(i + 1) - step * Eigen::Vector2d(velocity(i + 1), velocity(i + 2));
      if (force.norm() > limit) force *= limit / force.norm();
      x.segment<2>(i + 1) = force;
    }
  }
  return x;
}

// Few and many contacts are swept by other code, which looks ahead where there are many.
TEST(SweepProblem, SweepsRowAfterRow) {
  const Machine machine;
  std::mt19937 random(4);
  constexpr double kFriction = 0.6;
  SweepProblem problem(Machine::kDofs, machine.coupled, kFriction, 0);
  for (int n = 0; n < 240; ++n) {
    const int contacts = 1 + n % 24, bounded = n % 4, sweeps = 1 + n % 7;
    const Drawn drawn = draw(machine, random, contacts, bounded, n % 3 * 3, 0.02, problem);
    ASSERT_LE(problem.sweep(sweeps, 0), sweeps);  // fewer where one changed nothing at all
    const Eigen::VectorXd expected = swept_impulses(drawn, kFriction, sweeps);
    // Rounding alone: every row adds some 1e-16 of impulses of order 1, and rows repeat it.
    ASSERT_LT((impulses(problem, drawn) - expected).norm(), 1e-11 * (1 + expected.norm())) << n;
  }
}

TEST(SweepProblem, MakesNoMoreSweepsThanItMay) {
  const Machine machine;
  std::mt19937 random(3);
  SweepProblem problem(Machine::kDofs, machine.coupled, 0.5, 0);
  const Drawn first = draw(machine, random, 3, 2, 3, 0.01, problem);
  EXPECT_EQ(problem.sweep(7, 0), 7);
  const Drawn second = draw(machine, random, 3, 2, 3, 0.01, problem);
  const int loose = problem.sweep(20000, 1e-3);
  EXPECT_GT(loose, 1);
  EXPECT_LT(loose, 20000);
}

TEST(SweepProblem, WhatNothingMovesGetsNoImpulse) {
  SweepProblem problem(Machine::kDofs, Machine().coupled, 0.5, 0);
  problem.begin(nullptr);
  problem.add_contact({}, PointJacobian::Zero(3, Machine::kDofs), Vector3::Zero(), {-1, 1, 0});
  problem.sweep(10, 0);
  EXPECT_EQ(problem.contact_impulse(0).norm(), 0);
  EXPECT_EQ(problem.u().norm(), 0);
}

TEST(SweepProblem, WhatNothingMovesGetsNoImpulseAmongMany) {
  const Machine machine;
  SweepProblem problem(Machine::kDofs, machine.coupled, 0.5, 0);
  problem.begin(nullptr);
  PointJacobian Z = PointJacobian::Zero(3, Machine::kDofs);
  Z.leftCols<3>().setIdentity();
  constexpr int kContacts = 12;
  for (int i = 0; i < kContacts; ++i) {
    const bool moves = i % 2 == 1;
    problem.add_contact(moves ? std::span<const int>(machine.bodies[0]) : std::span<const int>(),
                        moves ? Z : PointJacobian::Zero(3, Machine::kDofs), Vector3::Zero(), {-1, 0.1, 0});
  }
  EXPECT_LT(problem.sweep(100, 1e-12), 100);
  double together = 0;
  for (int i = 0; i < kContacts; ++i) {
    if (i % 2 == 0) {
      EXPECT_EQ(problem.contact_impulse(i).norm(), 0) << i;
    }
    together += problem.contact_impulse(i)[0];
  }
  EXPECT_NEAR(together, 1, 1e-12);  // of unit mass, at 1 m/s
}

}  // namespace
}  // namespace crossgait::contact
