// A world of any dynamics code under a law made of LawFactors.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "backends/contact/contact_stage.h"
#include "backends/contact/tree_dynamics.h"

namespace crossgait::contact {

/// Steps a robot: dynamics, inertia and Jacobians are an engine's, and what joins, stops and touches
/// is the joint stage's and the contact stage's. The state is kept here, in float64.
class TreeBackend : public PhysicsBackend {
 public:
  /// @param make  the dynamics of the completed specification, which outlives it
  /// @param margin  how far above the ground points count where that is a factor, m; none: reach_margins
  /// @throws ConfigError where the law is MuJoCo's and the world asks for pyramidal cones
  TreeBackend(const WorldSpec& world, EngineInfo info, const LawFactors& factors,
              const std::function<std::unique_ptr<TreeDynamics>(const WorldSpec&)>& make,
              std::optional<double> margin = {});

  const EngineInfo& info() const override { return info_; }

 protected:
  void do_reset(const RobotState& state) override;
  StepStatus do_step(const JointVector& tau, const Wrench& base) noexcept override;
  void do_read_state(RobotState& state) const noexcept override;
  void do_read_contacts(ContactList& contacts) const noexcept override { contacts = contacts_.contacts(); }
  double do_terrain_height(double x, double y) const override;
  Pose do_body_pose(int body) const override;
  Eigen::MatrixXd do_mass_matrix() const override;
  SpatialInertia do_body_inertia(int body) const override { return dynamics_->inertia(body); }
  JointVector do_joint_friction() const override { return contacts_.joint_friction(); }
  JointRanges do_joint_limits() const override { return contacts_.joint_limits(); }
  void do_save(std::vector<double>& engine) const override;
  void do_restore(const std::vector<double>& engine) override;

 private:
  Vector3 p_BC_W() const { return q_WB_ * Vector3(dynamics_->X_BC().front().translation()); }
  void place() noexcept { dynamics_->place(make_pose(q_WB_, p_WC_), q_, v_); }
  void integrate(double h) noexcept;

  EngineInfo info_;
  // Declared in order of dependence: each holds references to the ones before.
  std::unique_ptr<TreeDynamics> dynamics_;
  BodyKinematics bodies_;
  std::vector<BodyFeature> features_;
  ContactFinder finder_;
  JointStage joints_;
  ContactStage contacts_;
  ContactPoints points_;

  Vector3 p_WC_ = Vector3::Zero();
  Quaternion q_WB_ = Quaternion::Identity();
  JointVector q_;
  DofVector v_, free_impulse_;  // TreeDynamics' degrees of freedom
};

/// Writes what a law says of an engine: laws, capabilities, parts of Crossgait's, and a mode in which
/// `library` stands for the dynamics. What the engine alone knows (name, version, precision) stays as it is.
void describe_law(const LawFactors& factors, const std::string& library, EngineInfo& info);

}  // namespace crossgait::contact
