// PhysX's articulation of a RobotDescription.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <PxPhysicsAPI.h>

#include "backends/physx/dry_friction.h"
#include "backends/physx/foundation.h"
#include "backends/physx/links.h"
#include "backends/physx/loop_constraint.h"
#include "backends/physx/settings.h"
#include "physics/engine/world_spec.h"
#include "physics/robot/implicit_servo.h"
#include "physics/robot/state.h"

namespace crossgait::physx {

/// Holds a tree of links in reduced coordinates with armature and dry friction in its joints, and the loops
/// between links. A link's frame is at its centre of mass along the principal axes of its inertia, so that
/// poses go in and come out as they are.
///
/// The state is float32 numbers in PhysX's cache; every step begins by giving them to PhysX anew, so that
/// nothing else is carried from step to step. PhysX's origin follows the base: places are float32 numbers
/// from there, which are as fine 10 km away as at home.
class ArticulationModel {
 public:
  /// @throws std::runtime_error if PhysX refuses a part
  ArticulationModel(const WorldSpec& spec, const Settings& settings, px::PxScene& scene);
  ~ArticulationModel();
  ArticulationModel(const ArticulationModel&) = delete;
  ArticulationModel& operator=(const ArticulationModel&) = delete;

  void set_state(const RobotState& state);
  void get_state(RobotState& state) const;
  /// Moves PhysX's origin towards the base where that is far from it; the state stays the same.
  void recentre() noexcept;
  /// Returns where PhysX's origin is in W, m.
  const Vector3& origin() const { return origin_; }
  /// Hands the state and torques (N m) to PhysX, the drives of implicit servos, and a wrench on the base, its
  /// force at the centre of mass.
  void apply(const JointVector& tau, std::span<const ImplicitServo> servos, const Wrench& base);
  /// Takes the state that a step left. @returns false if a number of it is not finite
  bool take();

  px::PxArticulationLink& link(int body) const { return *links_[static_cast<std::size_t>(body)]; }
  /// Returns the frame of a link in its body.
  const Pose& X_BP(int body) const { return X_BP_[static_cast<std::size_t>(body)]; }
  /// Returns velocities before the step that was taken, and after it, of the mass centre, in W: m/s, rad/s.
  const px::PxSpatialVelocity& velocity_before(int body) const { return before_[index(body)]; }
  const px::PxSpatialVelocity& velocity_after(int body) const { return cache()->linkVelocity[index(body)]; }
  /// Returns a body's group: bodies that loops hold together are one; others are one each.
  std::size_t group(int body) const { return groups_[static_cast<std::size_t>(body)]; }
  /// Computes forces of contact (N, in W) in the step that was taken, by group: what its change of momentum
  /// has beside gravity, joints and the push that was applied.
  void contact_forces(const Vector3& push, std::vector<Vector3>& by_group) const;

  Pose body_pose(int body) const;  ///< in W
  SpatialInertia body_inertia(int body) const;
  Eigen::MatrixXd mass_matrix();
  double joint_friction(int joint) const;  ///< N m
  /// Returns limits in rad; nothing for a joint that turns on.
  std::optional<std::pair<double, double>> joint_limits(int joint) const;

  /// Saves the state, number by number.
  void save(std::vector<double>& numbers) const;
  void restore(const double* numbers);

 private:
  void add_link(const std::vector<Body>& bodies, std::size_t i);
  void add_joint(const Body& body, std::size_t i);
  void set_drive(const ImplicitServo& servo);
  void add_loops(const Settings& settings);
  void apply_state();
  CacheOfStock& cache() const { return *cache_; }
  std::size_t index(int body) const { return indices_[static_cast<std::size_t>(body)]; }

  const WorldSpec& spec_;
  Articulation articulation_;
  Vector3 origin_ = Vector3::Zero();
  std::vector<Pose> X_BP_;
  std::vector<px::PxArticulationLink*> links_;  ///< by body
  std::vector<std::size_t> indices_;            ///< by body: PhysX's index of its link
  std::vector<std::size_t> dofs_;               ///< by joint: PhysX's index of it
  std::vector<std::size_t> groups_;             ///< by body
  std::vector<std::unique_ptr<LoopConstraint>> loops_;
  std::map<std::size_t, std::unique_ptr<DryFriction>> frictions_;  ///< by body, of implicit servos' joints
  std::unique_ptr<CacheOfStock> cache_;
  std::vector<px::PxSpatialVelocity> before_;
};

}  // namespace crossgait::physx
