// Where the robot touches the ground, found by Crossgait's closest-point routine.
#pragma once

#include <vector>

#include "backends/contact/body_kinematics.h"
#include "physics/engine/contact_features.h"
#include "physics/robot/state.h"

namespace crossgait::contact {

/// Says where a body can touch the terrain, in the frame C in which an engine takes points of it.
struct BodyFeature {
  ContactFeature feature;
  Vector3 p_CF = Vector3::Zero();     ///< centre, m
  Vector3 axis_C = Vector3::UnitZ();  ///< of a rim
};

/// Lists the features of all bodies that can move. @param X_BC  as in BodyKinematics
std::vector<BodyFeature> body_features(const RobotDescription& robot, bool fixed_base,
                                       const std::vector<Pose>& X_BC);

/// Returns how far above the ground points of each body count, m: Bullet's rule, so that what is said of one
/// engine holds of the other, two hundredths of how far a body reaches from the origin of C
/// (btCollisionShape::getContactBreakingThreshold).
std::vector<double> reach_margins(const std::vector<BodyFeature>& features, std::size_t bodies);

struct ContactPoint {
  int body = -1, leg = -1;  ///< as in Contact
  Vector3 p_WP, normal;     ///< midway between the surfaces, m; from terrain to robot
  double distance = 0;      ///< m, negative when penetrating
};
using ContactPoints = DeepestPoints<ContactPoint>;

class ContactFinder {
 public:
  /// @param margins  by body: how far above the ground points count, m; empty: only what touches does
  ContactFinder(std::vector<BodyFeature> features, const Terrain& terrain, std::vector<double> margins);

  const std::vector<BodyFeature>& features() const noexcept { return features_; }
  /// Adds to `points`.
  void find(const BodyKinematics& bodies, ContactPoints& points) const noexcept;

 private:
  void find_contact(const BodyFeature& of, const Vector3& centre, double margin,
                    ContactPoints& points) const noexcept;

  std::vector<BodyFeature> features_;
  const Terrain& terrain_;
  std::vector<double> margins_;
  std::vector<double> reach_;  // by body, of its features from the origin of C, m
};

}  // namespace crossgait::contact
