// Contacts and dry friction in joints of one step, by a law made of LawFactors.
#pragma once

#include <array>
#include <vector>

#include "crossgait/backends/contact/bounded_rows.h"
#include "crossgait/backends/contact/cone_solver.h"
#include "crossgait/backends/contact/contact_points.h"
#include "crossgait/backends/contact/joint_stage.h"
#include "crossgait/backends/contact/law_factors.h"

namespace crossgait::contact {

/// A joint with dry friction.
struct FrictionalJoint {
  int joint = -1;             ///< as in RobotDescription::joint
  double friction = 0;        ///< N m
  double inverse_weight = 0;  ///< MuJoCo's, 1/(kg m^2)
};
std::vector<FrictionalJoint> frictional_joints(const WorldSpec& spec);

/// With MuJoCo's factors contacts are placed midway between the surfaces, softened like MuJoCo's, and solved
/// over true friction cones; any of these can be another's.
class ContactStage {
 public:
  /// @param spec,bodies,joints  must outlive it
  ContactStage(const WorldSpec& spec, const LawFactors& factors, const BodyKinematics& bodies,
               const JointStage& joints);

  /// Forgets the contacts of the last step.
  void begin_step() noexcept { contacts_.clear(); }

  /// After the joint stage: solves and reports.
  /// @param before  velocities before the step
  /// @returns velocities after the step
  const DofVector& solve(const DofVector& before, const ContactPoints& points) noexcept;

  /// @param force,velocity_before  on the robot, N, and of the body at the point, m/s, in W
  void report(const ContactPoint& point, const Vector3& force, const Vector3& velocity_before) noexcept;
  const ContactList& contacts() const noexcept { return contacts_; }

  const std::vector<FrictionalJoint>& frictional_joints() const noexcept { return frictional_joints_; }

 private:
  void assemble(const DofVector& before, const ContactPoints& points) noexcept;
  void respond(Eigen::Index column, Eigen::MatrixXd& rows, Eigen::MatrixXd& projected) const noexcept;
  double set_row(const ContactPoint& point, int contact, int axis) noexcept;
  void apply(const ContactPoints& points) noexcept;

  // joint_friction.cpp
  void assemble_joint_friction(const DofVector& before) noexcept;
  void add_joint_friction(DofVector& change) const noexcept;

  const WorldSpec& spec_;
  LawFactors factors_;
  const BodyKinematics& bodies_;
  const JointStage& joints_;
  SoftLaw contact_law_, friction_law_;
  std::vector<double> inverse_weights_;  // MuJoCo's, by body, 1/kg
  std::vector<FrictionalJoint> frictional_joints_;

  ConeProblem cone_;
  BoundedRows joint_friction_;
  PointJacobian J_;
  Eigen::MatrixXd rows_;                               // dofs x 3 contacts: half_solve(J')
  Eigen::MatrixXd projected_;                          // the same after project()
  Eigen::MatrixXd joint_rows_, projected_joints_;      // likewise: dofs x joints with friction
  std::array<Eigen::Matrix3d, kMaxContacts> frames_;   // rows: normal, two tangents
  std::array<Vector3, kMaxContacts> velocity_before_;  // in that frame
  DofVector velocity_;
  ContactList contacts_;
};

}  // namespace crossgait::contact
