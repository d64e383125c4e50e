// Contacts, dry friction and limits of joints as a problem in the robot's velocities, solved by Newton's
// method.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "backends/contact/impulse_bounds.h"
#include "backends/contact/sparse_symmetric.h"
#include "physics/robot/state.h"

namespace crossgait::contact {

/// Minimises over u
///
///     1/2 u'u + 1/2 |E'u|^2 + sum of s(Z'u + b) over contacts + sum of h(z'u + b) over bounded rows,
///
/// where u are velocities in units in which the inertia is the identity (JointSpaceInertia::half_solve), E
/// the loops' rows over the root of their regularisation, and s and h the least costs of impulses x that
/// their bounds allow: s(y) = max over the cone |tangents| <= friction * normal of -y'x - 1/2 x'Rx, and h
/// likewise within the bounds of x. That is the problem MuJoCo's Newton solver has (MuJoCo 2.2 manual,
/// "Computation > Constraint model", primal problem; Todorov 2014), and the dual of ConeProblem and
/// BoundedRows. Its Hessian has the size of the robot, however many contacts there are.
/// @tparam kRows  of a contact: the normal and two tangents, with torsion, with rolling about both tangents:
///                3, 4 or 6. Friction of all of them shares one cone.
template <int kRows>
class PrimalProblemOf {
 public:
  static constexpr int kMaxIterations = 100;
  using Rows = Eigen::Matrix<double, kRows, 1>;
  using RowsJacobian = Eigen::Matrix<double, kRows, Eigen::Dynamic, 0, kRows, kMaxDofs>;

  /// @param coupled  sets of dofs: those of the rows that will be added, and of the loops
  PrimalProblemOf(int dofs, const std::vector<std::vector<int>>& coupled, double friction);

  /// Begins without any row. Both have to stay as they are until `solve` is done.
  /// @param inertia  1 + E E', of the pattern of `coupled`  @param loops  E: dofs x rows
  void begin(const SparseSymmetric& inertia, const Eigen::MatrixXd& loops) noexcept;
  /// Adds a contact, up to kMaxContacts.
  /// @param dofs  that it moves, rising; has to stay as it is until `solve` is done
  /// @param Z     kRows x dofs, of which those columns alone are read
  /// @param R     regularisation, > 0, the same for both tangents; of torsion and rolling such that
  ///              coefficient^2 R is as of the tangents, which makes the cone a round one
  void add_contact(std::span<const int> dofs, const RowsJacobian& Z, const Rows& R, const Rows& b) noexcept;
  /// Adds a row whose impulse is bounded, up to kMaxBoundedRows. @param z  by dofs, R > 0
  void add_bounded(std::span<const int> dofs, const DofVector& z, double R, double b,
                   const ImpulseBounds& bounds) noexcept;

  /// Solves by Newton's method with an exact line search, from `guess` or zero, whichever is better.
  /// @param tolerance  stops when u is known to this share of it. (The Hessian is at least the identity: u is
  /// no further from the solution than the gradient is long.)
  /// @returns iterations
  int solve(const DofVector& guess, double tolerance) noexcept;

  const DofVector& u() const noexcept { return u_; }
  /// Returns the impulse of the contact that was added as the i-th.
  Rows contact_impulse(int i) const noexcept;
  double bounded_impulse(int i) const noexcept;

 private:
  using Response = Eigen::Matrix<double, kRows, kRows>;
  enum class Zone { kApart, kStick, kSlip };
  // In units of R^(1/2): the impulse of a contact is then the point of its cone nearest to -y, and its cost
  // half the square of that.
  struct Contact {
    std::span<const int> dofs;
    int first;  // column of Z_
    double slope;
    Rows scale;          // R^(-1/2)
    Rows b, y, step, x;  // y = Z'u + b, step = Z'd, x impulse
    Zone zone;
  };
  struct Bounded {
    std::span<const int> dofs;
    int first;
    ImpulseBounds bounds;
    double scale, b, y, step, x;

    double impulse(double at) const noexcept { return std::clamp(-at, bounds.lower, bounds.upper); }
    bool between(double at) const noexcept { return -at >= bounds.lower && -at <= bounds.upper; }
  };
  struct Slope {
    double first, second;  // derivatives
  };

  static double tangent_of(const Rows& y) noexcept;
  static Rows project(const Contact& contact, const Rows& y, Zone& zone) noexcept;
  static Response response(const Contact& contact, const Rows& y, Zone zone) noexcept;
  Rows product(const Contact& contact, const DofVector& v) const noexcept;
  double product(const Bounded& row, const DofVector& v) const noexcept;
  double evaluate() noexcept;
  void find_gradient() noexcept;
  void find_hessian() noexcept;
  Slope slope_at(double a) const noexcept;
  double search_line() noexcept;

  double friction_;
  int columns_ = 0, contact_count_ = 0, bounded_count_ = 0;
  std::array<Contact, kMaxContacts> contacts_;
  std::array<Bounded, kMaxBoundedRows> bounded_;
  Eigen::Matrix<double, kRows, Eigen::Dynamic>
      Z_;  // of all rows, one after the other; of a bounded one the first row
  const Eigen::MatrixXd* loops_ = nullptr;
  Eigen::VectorXd loops_u_, loops_d_;  // E'u, E'd
  const SparseSymmetric* constant_ = nullptr;
  SparseSymmetric hessian_;
  DofVector u_, gradient_, d_;
  Slope line_{};  // along d_ of what is not rows
};

extern template class PrimalProblemOf<3>;
extern template class PrimalProblemOf<4>;
extern template class PrimalProblemOf<6>;
using PrimalProblem = PrimalProblemOf<3>;

}  // namespace crossgait::contact
