// PhysX's articulation as a code for dynamics alone.
#pragma once

#include <memory>
#include <vector>

#include <PxPhysicsAPI.h>

#include "backends/contact/tree_dynamics.h"
#include "backends/physx/foundation.h"
#include "backends/physx/links.h"
#include "physics/engine/world_spec.h"

namespace crossgait::physx {

/// Takes forward dynamics from a step of PhysX's in a scene without ground, of which the accelerations alone
/// are read, and Jacobians and poses from its articulation; M0 is the sum of J' I J over its links. All of it
/// is float32, of a state that is float64 outside. What PhysX offers for inverse dynamics does not do: it
/// leaves out the base (computeJointAcceleration), or has taken it out (computeGeneralizedMassMatrix: M_qq -
/// M_qb M_bb^-1 M_bq, without armature).
///
/// The base is at the origin and does not move along: neither changes forces, and the one would cost digits
/// of places far from the origin, the other of accelerations.
class TreeModel final : public contact::TreeDynamics {
 public:
  /// @throws std::runtime_error if PhysX refuses a part, ConfigError in a fork of the process that made it
  explicit TreeModel(const WorldSpec& spec);
  ~TreeModel() override;
  TreeModel(const TreeModel&) = delete;
  TreeModel& operator=(const TreeModel&) = delete;

  void renew() override;
  void place(const Pose& X_WC, const JointVector& q, const contact::DofVector& v) noexcept override;
  void free_impulse(double h, const Wrench& base, const contact::JointSpaceInertia& inertia,
                    const contact::DofVector& v, contact::DofVector& p) noexcept override;
  void bare_inertia(contact::JointSpaceInertia& inertia) noexcept override;
  void point_jacobian(int body, const Vector3& p_WP, contact::PointJacobian& J) const noexcept override;

  const std::vector<Pose>& X_BC() const noexcept override { return X_BC_; }
  const Pose& X_WC(int body) const noexcept override { return X_WC_[static_cast<std::size_t>(body)]; }
  SpatialInertia inertia(int body) const override;

 private:
  using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, contact::kMaxDofs>;

  void build();
  void clear();
  void apply() noexcept;
  void read_jacobians() noexcept;

  const WorldSpec& spec_;
  InlineDispatcher dispatcher_;
  std::unique_ptr<px::PxScene, Release> scene_;
  Articulation articulation_;
  std::vector<px::PxArticulationLink*> links_;  ///< by body
  std::vector<std::size_t> indices_;            ///< by body: PhysX's index of its link
  std::vector<std::size_t> dofs_by_joint_;      ///< PhysX's index of it
  std::vector<std::vector<int>> dofs_;          ///< by body: those that move it, rising
  std::unique_ptr<CacheOfStock> cache_;
  std::vector<Pose> X_BP_, X_BC_, X_PC_;  ///< by body; P is the frame of a link
  std::vector<Pose> X_WC_;                ///< of the state that was placed
  std::vector<Vector3> p_WP_;             ///< centres of mass
  std::vector<Jacobian> jacobians_;       ///< by body, of its centre of mass: angular, then linear
  Jacobian momentum_;
  int first_ = 0;  ///< dof that can move
  bool poisoned_ = false;
};

}  // namespace crossgait::physx
