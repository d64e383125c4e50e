// Contact impulses: a quadratic problem over a product of friction cones.
#pragma once

#include <array>

#include "physics/core/math.h"
#include "physics/robot/state.h"

namespace crossgait::contact {

/// Says what bounds friction in `solve_coulomb`: the disc of radius friction * normal; a pyramid, each
/// tangent by itself; or a pyramid whose size is not that of the normal impulses but of those that there
/// would be without friction (what Baraff's and Dantzig's algorithm of the Open Dynamics Engine, and DART's
/// after it, works with).
enum class FrictionBound : unsigned char { kDisc, kPyramid, kFrictionlessPyramid };

/// Minimises 1/2 x'Ax + b'x over contacts x_i = (normal, tangent, tangent) with |tangents| <= friction *
/// normal. This is the dual of PrimalProblem: the cone couples normal and friction, whereas Bullet's own
/// projection bounds friction by the normal impulse of the previous sweep.
struct ConeProblem {
  static constexpr int kMaxRows = 3 * kMaxContacts;

  ConeProblem() : A(kMaxRows, kMaxRows), b(kMaxRows), x(kMaxRows) {}

  int contacts = 0;
  double friction = 0;
  FrictionBound bound = FrictionBound::kDisc;
  Eigen::MatrixXd A;  ///< leading 3 contacts square block, symmetric positive definite
  Eigen::VectorXd b;  ///< leading 3 contacts
  Eigen::VectorXd x;  ///< result, leading 3 contacts

  /// Solves by block Gauss-Seidel with an exact solution per contact, from zero.
  /// @param tolerance stops when no impulse changes by more than this share of the largest
  /// @returns sweeps taken
  int solve(double tolerance, int max_sweeps) noexcept;

  /// Solves Coulomb's law instead, as rows of Bullet's kind converge to: with w = A x + b, each normal has x
  /// >= 0, w >= 0 and x w = 0 whatever friction does, and its tangents are the point of the disc of radius
  /// friction * normal that opposes w best. Projected Gauss-Seidel over rows, from zero (Jourdan, Alart and
  /// Jean 1998). No minimum of anything: the cone of `solve` lets a sliding contact lift, this does not.
  int solve_coulomb(double tolerance, int max_sweeps) noexcept;

  /// Says how much impulses changed in a sweep, and how large they are.
  struct Sweep {
    double change = 0, largest = 0;
  };
  /// Does one sweep over all contacts, from `x`.
  Sweep sweep() noexcept;
  Sweep sweep_coulomb() noexcept;
  /// Finds, before the first `sweep_coulomb`, what bounds friction where that is given.
  void begin_coulomb(double tolerance, int max_sweeps) noexcept;

 private:
  std::array<double, kMaxContacts> frictionless_{};  ///< normal impulses without friction
};

/// Finds argmin 1/2 x'Hx + g'x over one cone. `start` seeds the search on the cone's surface.
Vector3 solve_cone_block(const Matrix3& H, const Vector3& g, double friction, const Vector3& start) noexcept;

}  // namespace crossgait::contact
