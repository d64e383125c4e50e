// The btMultiBody of a RobotDescription, and where its parts went.
#pragma once

#include <memory>
#include <vector>

#include <BulletDynamics/Featherstone/btMultiBody.h>

#include "crossgait/backends/bullet/joint_stage.h"
#include "crossgait/physics/contact_features.h"
#include "crossgait/physics/world_spec.h"

namespace crossgait::bullet {

/// Where a link can touch the terrain. (Bullet's own routine loses small boxes on height fields, and finds
/// one point of a cylinder per step and gathers more over several, which a restored run could not repeat.)
struct LinkFeature {
  ContactFeature feature;
  int link = -1;                      ///< Bullet link, -1 for the base
  Vector3 p_CF = Vector3::Zero();     ///< centre in the link's centre-of-mass frame, m
  Vector3 axis_C = Vector3::UnitZ();  ///< of a rim, in that frame

  /// In the world, where `body` has it.
  SphereCentres centres(const btMultiBody& body, const Terrain& terrain, double margin) const noexcept;
};

/// A joint with dry friction.
struct FrictionalJoint {
  int link = -1;              ///< Bullet link that it moves
  double friction = 0;        ///< N m
  double inverse_weight = 0;  ///< MuJoCo's, 1/(kg m^2)
};

/// Bullet keeps link frames at the centre of mass along principal axes; bodies and links count apart by one
/// (body i + 1 is link i, body 0 is the base).
class MultibodyModel {
 public:
  explicit MultibodyModel(const WorldSpec& spec);

  btMultiBody& body() noexcept { return *body_; }
  const btMultiBody& body() const noexcept { return *body_; }
  /// Pose of the principal frame P in the body's own frame.
  const Pose& X_BP(int body) const { return X_BP_[static_cast<std::size_t>(body)]; }
  JointVector armature() const;
  std::vector<FrictionalJoint> frictional_joints() const;
  std::vector<LoopPoints> loop_points() const;
  /// Those of all bodies that can move.
  std::vector<LinkFeature> contact_features() const;
  /// MuJoCo's inverse weight by Bullet link + 1, 1/kg.
  const std::vector<double>& inverse_weights() const { return inverse_weights_; }

 private:
  const WorldSpec& spec_;
  std::vector<Pose> X_BP_;
  std::vector<double> inverse_weights_;
  std::unique_ptr<btMultiBody> body_;
};

}  // namespace crossgait::bullet
