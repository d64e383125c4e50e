// What can only push so hard: contacts with the ground, and dry friction in joints.
#pragma once

#include <vector>

#include "dynamics.h"

#include "crossgait/physics/engine/contact_features.h"
#include "crossgait/physics/engine/world_spec.h"

namespace crossgait::skeleton {

/// Solves hard contact with Coulomb's friction, at the level of velocities. A point under the ground is to
/// leave it by a fifth of its depth in the next step, one above it may just reach it; its normal impulse
/// pushes, and its friction, at most `friction` times that, opposes the slip. Joints are to stop, within
/// their friction. Solved by projected Gauss-Seidel (e.g. Catto, Iterative Dynamics with Temporal Coherence,
/// 2005), without anything kept from the last step.
class Contacts {
 public:
  /// @param spec  has to outlive it
  explicit Contacts(const WorldSpec& spec);

  /// Changes `velocity`, which the robot would have without this.
  /// @param response  factors of what is multiplied with a velocity to give an impulse
  void solve(const Dynamics& dynamics, const Eigen::LLT<DofMatrix>& response, DofVector& velocity) noexcept;

  /// Returns the contacts of the last step.
  const ContactList& list() const noexcept { return list_; }
  void clear() noexcept { list_.clear(); }
  JointVector joint_friction() const;  ///< N m

 private:
  struct Point {
    int body = 0, leg = -1;
    Vector3 p_WP, normal;
    double distance = 0;  // m
  };
  // Normal, and two directions across it.
  struct PointRows {
    Matrix3 axes;  // columns in W
    PointJacobian J;
    Eigen::Matrix<double, Eigen::Dynamic, 3, 0, kMaxDofs, 3> W;  // change of velocity per impulse
    double normal_response, friction_response, wanted;           // 1/kg, 1/kg, m/s
    Vector3 impulse;                                             // N s
  };
  struct JointRow {
    Eigen::Index dof = 0;
    double bound = 0;  // N m s
    DofVector W;
    double impulse = 0;
  };
  struct Change {
    double largest = 0, size = 0;
    void add(double change, double value);
  };

  void find(const Dynamics& dynamics) noexcept;
  void find_at(const ContactFeature& feature, const Vector3& centre) noexcept;
  void make_rows(const Dynamics& dynamics, const Eigen::LLT<DofMatrix>& response) noexcept;
  static void sweep(JointRow& row, DofVector& velocity, Change& change) noexcept;
  void sweep(PointRows& rows, DofVector& velocity, Change& change) const noexcept;
  void report(const Dynamics& dynamics) noexcept;

  const WorldSpec& spec_;
  std::vector<ContactFeature> features_;
  DeepestPoints<Point> points_;
  std::vector<PointRows> rows_;  // of the points
  std::vector<JointRow> joints_;
  ContactList list_;
};

}  // namespace crossgait::skeleton
