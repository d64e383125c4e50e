// Single constraint rows with bounded impulses (dry friction and limits of joints), solved along with the
// contacts.
#pragma once

#include <array>

#include "backends/contact/cone_solver.h"
#include "backends/contact/impulse_bounds.h"

namespace crossgait::contact {

/// Solves rows with w = A x + C y + b, where y are the contacts' impulses, such that x is at its upper bound
/// where w < 0, at its lower one where w > 0 and between the two where w = 0: the minimum of 1/2 x'Ax + (C y
/// + b)'x within the bounds. Friction of stuck joints is stiff against the contacts (with Gauss-Seidel sweeps
/// over both a step takes four to eight times as long as without friction), so rows between their bounds are
/// eliminated exactly, and the contacts are solved in what remains.
class BoundedRows {
 public:
  static constexpr int kMostSolutions = 30;

  /// @param most  rows that there may be, up to kMaxBoundedRows
  explicit BoundedRows(int most);

  int count = 0;
  std::array<ImpulseBounds, kMaxBoundedRows> bounds{};  ///< leading `count`
  Eigen::MatrixXd A;  ///< leading `count` square block, symmetric positive definite
  Eigen::MatrixXd C;  ///< leading count x 3 contacts
  Eigen::VectorXd b;  ///< leading `count`
  Eigen::VectorXd x;  ///< result, leading `count`

  /// Solves for x and the contacts together. Which rows are at a bound is found by block principal pivoting
  /// (Judice and Pires 1994): all rows that are on the wrong side change theirs, and where that does not
  /// settle, the first one alone (Murty 1974). Hard rows and hard contacts of a standing robot can be more
  /// than it has degrees of freedom, and pivot for ever: then both are swept.
  /// @param coulomb  the law of ConeProblem::solve_coulomb instead of that of solve
  /// @returns solutions of the contacts that it took; kMostSolutions where it swept
  int solve(const ConeProblem& contacts, bool coulomb, double tolerance, int max_sweeps) noexcept;

  /// Returns the impulses of the contacts; their rows are the leading 3 contacts.
  const Eigen::VectorXd& contact_impulses() const noexcept { return reduced_.x; }

 private:
  enum class Side : signed char { kLower = -1, kBetween, kUpper };

  Side side_of(Eigen::Index row, double tolerance) const noexcept;
  bool pivot(bool all, double tolerance) noexcept;
  void eliminate(const ConeProblem& contacts) noexcept;
  void finish(Eigen::Index contact_rows) noexcept;
  void sweep(const ConeProblem& contacts, bool coulomb, double tolerance, int max_sweeps) noexcept;
  double velocity(Eigen::Index row) const noexcept;
  double clamp(Eigen::Index row, double impulse) const noexcept;

  std::array<Side, kMaxBoundedRows> sides_{};
  std::array<Eigen::Index, kMaxBoundedRows> between_{};  ///< rows that are eliminated
  Eigen::Index between_count_ = 0;
  Eigen::MatrixXd L_;    ///< of the rows between: their A = L L'
  Eigen::MatrixXd LC_;   ///< L^-1 C of them
  Eigen::VectorXd Lb_;   ///< L^-1 b of them, with the rows at their bounds in b
  ConeProblem reduced_;  ///< the contacts, with the rows between eliminated
};

}  // namespace crossgait::contact
