// Contacts by Coulomb's law, dry friction and limits of joints, solved by projected Gauss-Seidel sweeps over
// velocities.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "backends/contact/anderson_mixing.h"
#include "backends/contact/impulse_bounds.h"
#include "backends/contact/lookahead_sweep.h"
#include "backends/contact/sparse_symmetric.h"
#include "backends/contact/swept_contact.h"
#include "physics/robot/state.h"

namespace crossgait::contact {

/// Obeys ConeProblem::solve_coulomb's law: each normal impulse pushes and stops its approach whatever
/// friction does, its tangents are the point of the disc of radius friction * normal that opposes slip best.
///
/// Sweeps go over the rows as Bullet's do (btMultiBodyConstraintSolver::solveSingleIteration): bounded rows,
/// in turns from either end, then all normals, then the tangents of each contact together. What a row has
/// done to the robot is kept as velocities, in units in which the inertia of the robot with its loops is the
/// identity; there a row is as long as the path from its body to the base, whereas in joint velocities (and
/// in Bullet) its response is as long as the robot.
class SweepProblem {
 public:
  /// @param coupled  as in PrimalProblem
  /// @param mixing   as in DualProblem
  SweepProblem(int dofs, const std::vector<std::vector<int>>& coupled, double friction, double mixing);

  /// Begins to be filled in like PrimalProblem, R >= 0.
  /// @param held  1 + E E', factored, of the pattern of `coupled`; nullptr without loops. To stay as it is
  ///              until the sweeps are done
  void begin(const SparseSymmetric* held) noexcept;
  void add_contact(std::span<const int> dofs, const PointJacobian& Z, const Vector3& R,
                   const Vector3& b) noexcept;
  void add_bounded(std::span<const int> dofs, const DofVector& z, double R, double b,
                   const ImpulseBounds& bounds) noexcept;

  /// Sweeps from zero, as Bullet does it, until no row's velocity changes by more than `enough` in a sweep,
  /// m/s or rad/s (of two tangents the sum, signs and all: so it is in Bullet), or `max_sweeps` are done.
  /// @returns sweeps
  int sweep(int max_sweeps, double enough) noexcept;
  /// Sweeps until no impulse changes by more than this share of the largest, now and then from where the last
  /// sweeps lead to (AndersonMixing). @returns sweeps
  int converge(int max_sweeps, double share) noexcept;

  /// Returns velocities as in PrimalProblem.
  const DofVector& u() const noexcept { return u_; }
  Vector3 contact_impulse(int i) const noexcept { return contacts_[static_cast<std::size_t>(i)].x; }
  double bounded_impulse(int i) const noexcept { return bounded_[static_cast<std::size_t>(i)].x; }

 private:
  struct Bounded {
    const std::vector<int>* dofs;
    int first;
    double R, b;
    ImpulseBounds bounds;
    double step, x;
  };

  const std::vector<int>& reach(std::span<const int> dofs) const noexcept;
  bool many() const noexcept;
  std::span<SweptContact> swept() noexcept;
  void begin_sweeps() noexcept;
  double sweep_once(bool bounded_forward) noexcept;
  double sweep_bounded(bool forward) noexcept;
  double sweep_normals() noexcept;
  double sweep_tangents() noexcept;
  Eigen::Index rows() const noexcept { return bounded_count_ + 3 * contact_count_; }
  void begin_mixing() noexcept;
  void gather(Eigen::Ref<Eigen::VectorXd> impulses) const noexcept;
  double largest_push() const noexcept;
  void move_to(const Eigen::Ref<const Eigen::VectorXd>& impulses) noexcept;
  void finish() noexcept;

  double friction_, mixing_;
  int columns_ = 0, contact_count_ = 0, bounded_count_ = 0;
  std::array<SweptContact, kMaxContacts> contacts_;
  std::array<Bounded, kMaxBoundedRows> bounded_;
  const SparseSymmetric* held_ = nullptr;
  std::vector<std::vector<int>> reach_;  // by the last dof of a row's
  PointJacobian row_;
  Eigen::Matrix3Xd Z_;
  DofVector w_, u_;
  LookaheadSweep lookahead_;  // of many contacts
  AndersonMixing mixer_;
  Eigen::VectorXd before_, after_;  // impulses of all rows: bounded ones, then contacts
};

}  // namespace crossgait::contact
