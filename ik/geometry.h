// What the kinematics need to know of a five-bar leg, derived from the robot description.
#pragma once

#include "ik/tilt_mount.h"
#include "physics/robot/leg.h"
#include "physics/robot/robot.h"

namespace crossgait {

/// Describes a five-bar leg on a tilt joint, or on the base: then its plane is y = 0 of the leg frame, and
/// nothing but p_BL and `side` is used of the mount. Chain a is shoulder_left (the rear one), chain b
/// shoulder_right; both shoulders may have one axis.
struct FiveBarGeometry : TiltMount {
  bool has_tilt = true;
  TwoLinkChain a, b;

  /// Returns the distance of the two shoulder axes, m.
  double base_distance() const { return b.shoulder_x - a.shoulder_x; }
};

/// Derives the geometry of one leg from the joint frames of `robot`.
/// @throws ConfigError naming the joint if the leg is not a five-bar: the tilt axis, if any, along x of the
///   base; shoulder and elbow axes along y at zero tilt; both shoulders at one height, shoulder_left not
///   ahead of shoulder_right; the lower links joined by a loop closure at the foot's centre.
FiveBarGeometry five_bar_geometry(const RobotDescription& robot, Leg leg);

/// Returns `five_bar_geometry` of all legs.
LegArray<FiveBarGeometry> five_bar_geometry(const RobotDescription& robot);

/// @throws ConfigError (naming `source`) unless lengths are positive and the chains can meet everywhere
/// between the
///   two shoulders' reach, which `clamp_to_workspace` relies on.
void validate(const FiveBarGeometry& geometry, const std::string& source);

}  // namespace crossgait
