// The btMultiBody of a RobotDescription, and where its parts went.
#pragma once

#include <memory>
#include <vector>

#include <BulletDynamics/Featherstone/btMultiBody.h>

#include "backends/contact/contact_points.h"
#include "physics/engine/world_spec.h"

namespace crossgait::bullet {

/// Bullet keeps link frames at the centre of mass along principal axes; bodies and links count apart by one
/// (body i + 1 is link i, body 0 is the base).
class MultibodyModel {
 public:
  explicit MultibodyModel(const WorldSpec& spec);

  btMultiBody& body() noexcept { return *body_; }
  const btMultiBody& body() const noexcept { return *body_; }
  /// Returns the pose of the principal frame P in the body's own frame.
  const Pose& X_BP(int body) const { return X_BP_[static_cast<std::size_t>(body)]; }
  /// Returns the poses of all bodies.
  const std::vector<Pose>& X_BP() const { return X_BP_; }
  /// Lists the features with which bodies that can move touch the terrain. (Bullet's own routine loses small
  /// boxes on height fields, and finds one point of a cylinder per step and gathers more over several, which
  /// a restored run could not repeat.)
  std::vector<contact::BodyFeature> contact_features() const;

 private:
  const WorldSpec& spec_;
  std::vector<Pose> X_BP_;
  std::unique_ptr<btMultiBody> body_;
};

}  // namespace crossgait::bullet
