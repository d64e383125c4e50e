// Sweeps over many contacts, the same as SweepProblem's but for rounding, in half the time.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "backends/contact/swept_contact.h"
#include "backends/contact/tree_dynamics.h"

namespace crossgait::contact {

/// Begins a row's product before its turn. By turns alone each row reads the velocities that the row before
/// has just written, and that takes longer than all the arithmetic: a product with the base's six velocities,
/// a step, and six velocities written. So the product is begun while the rows before are still at work, and
/// what those do meanwhile is added by one number each, the response of the one row to the other:
///   z_i . w_now = z_i . w_then + (z_i . z_j) dx_j    for each row j since then.
/// Looks two rows ahead along normals, one contact ahead along tangents.
class LookaheadSweep {
 public:
  /// @param dofs  of the robot, at least the base's six
  explicit LookaheadSweep(int dofs);

  /// Takes the rows of `contacts` and their impulses.
  /// @param Z  as in SweptContact
  /// @param w  velocities that all rows together make, to stay where they are: sweeps change them
  void begin(std::span<const SweptContact> contacts, const Eigen::Matrix3Xd& Z, DofVector& w) noexcept;

  /// Lets each normal impulse push and stop its approach.
  double sweep_normals() noexcept;
  /// Lets the tangents of each contact together oppose slip, in the disc of radius friction * normal.
  double sweep_tangents(double friction) noexcept;

  /// Sets the impulses of the contacts of `begin`.
  void set_impulses(std::span<const SweptContact> contacts) noexcept;
  void get_impulses(std::span<SweptContact> contacts) const noexcept;

 private:
  using BaseRow = Eigen::Matrix<double, 6, 1>;
  // "asked" is what a row asks its impulse to change by: -step * velocity. Rows whose name begins so are
  // scaled by -step.
  struct NormalJoint {  // beyond the base
    double* w;
    double z, asked_z;
  };
  struct NormalRow {
    BaseRow z = BaseRow::Zero(), asked_z = z;
    double asked_b = 0, asked_R = 0, asked_last = 0,
           asked_last_but_one = 0;  // the latter two per impulse of rows before
    double inverse_step = 0, x = 0;
    const NormalJoint *joints = nullptr, *joints_end = nullptr;
  };
  struct TangentJoint {
    double* w;
    double z1, z2, asked_z1, asked_z2;
  };
  struct TangentRows {
    BaseRow z1 = BaseRow::Zero(), z2 = z1, asked_z1 = z1, asked_z2 = z1;
    Eigen::Vector2d asked_b = {0, 0}, asked_R = asked_b, x = asked_b;
    Eigen::Matrix2d asked_last = Eigen::Matrix2d::Zero();
    double inverse_step = 0;
    const TangentJoint *joints = nullptr, *joints_end = nullptr;
  };

  void set_rows(std::size_t i, const SweptContact& contact, const Eigen::Matrix3Xd& Z) noexcept;
  void look_back(std::size_t i) noexcept;

  DofVector* w_ = nullptr;
  std::size_t count_ = 0;
  // Behind the last contact's are rows of zeros for it to look ahead to.
  std::array<NormalRow, kMaxContacts + 2> normals_;
  std::array<TangentRows, kMaxContacts + 1> tangents_;
  std::vector<NormalJoint> normal_joints_;
  std::vector<TangentJoint> tangent_joints_;
};

}  // namespace crossgait::contact
