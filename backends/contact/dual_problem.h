// Contacts, dry friction and limits of joints as a problem in their impulses, solved by sweeps.
#pragma once

#include <span>

#include "backends/contact/bounded_rows.h"
#include "backends/contact/cone_solver.h"
#include "backends/contact/joint_stage.h"

namespace crossgait::contact {

/// Solves what laws need that have no primal problem: rows without regularisation, and Coulomb's law. Filled
/// in as PrimalProblem is; grows with the number of contacts squared.
class DualProblem {
 public:
  /// @param joints  must outlive it
  /// @param bound   of friction, by Coulomb's law
  /// @param mixing  added to the response of a contact's rows to themselves, as a share of it
  DualProblem(const JointStage& joints, int most_bounded, FrictionBound bound, double mixing);

  void begin() noexcept;
  /// Adds a contact as PrimalProblem does, R >= 0.
  void add_contact(std::span<const int> dofs, const PointJacobian& Z, const Vector3& R,
                   const Vector3& b) noexcept;
  void add_bounded(std::span<const int> dofs, const DofVector& z, double R, double b,
                   const ImpulseBounds& bounds) noexcept;

  /// @param coulomb  the law of ConeProblem::solve_coulomb instead of that of solve
  void solve(double friction, bool coulomb, double tolerance) noexcept;

  const DofVector& u() const noexcept { return u_; }
  Vector3 contact_impulse(int i) const noexcept { return cone_.x.segment<3>(3 * i); }

 private:
  const JointStage& joints_;
  double mixing_;
  ConeProblem cone_;
  BoundedRows bounded_;
  Eigen::MatrixXd rows_, projected_;                  // dofs x 3 contacts: Z', and what the loops leave of it
  Eigen::MatrixXd bounded_rows_, projected_bounded_;  // likewise: dofs x bounded rows
  DofVector u_;
};

}  // namespace crossgait::contact
