// Contacts of which none slips, as the linear problem that they are then.
#pragma once

#include <array>
#include <span>

#include "backends/contact/impulse_bounds.h"
#include "backends/contact/joint_space_inertia.h"
#include "physics/robot/state.h"

namespace crossgait::contact {

/// Solves Z Z' x + R x = -b for rows whose impulses nothing bounds: normals that push, tangents within their
/// cone, joints between their bounds. By conjugate gradients over the robot's velocities (Hestenes and
/// Stiefel 1952, preconditioned by each row's own response), from where the sweeps are: of more rows than the
/// robot has degrees of freedom the solution nearest to that is found.
class StickingRows {
 public:
  void clear() noexcept { count_ = 0; }
  /// Adds a row, up to kMaxRows. @param x      its impulse, N s, which `solve` changes
  /// @param dofs, first, lane  its entries are those of Z at (lane, first) and on, one for each of the dofs
  /// @param step               impulse per velocity of the row alone
  /// @param left               velocity that it has left to undo, m/s or rad/s
  void add(double& x, std::span<const int> dofs, int first, int lane, double R, double step,
           double left) noexcept {
    rows_[static_cast<std::size_t>(count_++)] = {&x, dofs, first, lane, R, step, left, 0, x};
  }
  /// Moves impulses, and with them the robot's velocities `w`, until no row wants to change by more than
  /// `enough`, N s. After `most` steps everything is left as it was: rows of which there are more than the
  /// robot can move may contradict each other, and then some contact slips or comes off. @returns steps
  int solve(const Eigen::Matrix3Xd& Z, DofVector& w, int most, double enough) noexcept;

 private:
  static constexpr int kMaxRows = 3 * kMaxContacts + kMaxBoundedRows;
  struct Row {
    double* x;
    std::span<const int> dofs;
    int first, lane;
    double R, step, left, along, before;  // direction of search, and the impulse before it
  };

  std::array<Row, kMaxRows> rows_;
  int count_ = 0;
};

}  // namespace crossgait::contact
