// What the kinematics need to know of a five-bar leg, derived from the robot description.
#pragma once

#include "crossgait/physics/leg.h"
#include "crossgait/physics/math.h"
#include "crossgait/physics/robot.h"

namespace crossgait {

using Vector2 = Eigen::Vector2d;

struct JointLimits {
  double lower = -3.14159265358979323846;  ///< rad
  double upper = 3.14159265358979323846;   ///< rad
};

/// One of the two chains of a five-bar: shoulder, upper link, elbow, lower link. Vectors lie in the leg's
/// plane and are written (x forward, depth); plane angles are measured from +x towards the depth.
struct FiveBarChain {
  double shoulder_x = 0;        ///< of the shoulder axis in the leg frame, m
  double upper = 0;             ///< length of the upper link, m
  double lower = 0;             ///< length of the lower link, m
  Vector2 upper_zero = {0, 1};  ///< unit direction of the upper link at zero shoulder angle and zero tilt
  Vector2 lower_zero = {1,
                        0};  ///< (cos, sin) of the plane angle from upper to lower link at zero elbow angle
  double shoulder_sign = 1;  ///< +1 if a positive joint angle increases the plane angle, else -1
  double elbow_sign = 1;     ///< the same for the elbow
  JointLimits shoulder_limits, elbow_limits;
};

/// A five-bar leg on a tilt joint. Chain a is shoulder_left (the rear one), chain b shoulder_right.
///
/// The **leg frame** has its origin midway between the two shoulder axes, in the plane of the foot, at zero
/// tilt; its axes are those of the base (x forward, y left, z up): p_BF = p_BL + p_LF. What is below the
/// shoulders has negative z.
struct FiveBarGeometry {
  Vector3 p_BL = Vector3::Zero();    ///< origin of the leg frame in the base frame, m
  double side = 1;                   ///< +1 where outward is +y (left legs), -1 for right legs
  double axis_to_plane_out = 0;      ///< from the tilt axis to the plane of the leg, outward at zero tilt, m
  double axis_to_shoulder_down = 0;  ///< from the tilt axis down to the shoulder axes at zero tilt, m
  double tilt_sign = 1;              ///< +1 if a positive tilt angle swings the foot outward, else -1
  JointLimits tilt_limits;
  FiveBarChain a, b;

  /// Distance of the two shoulder axes, m.
  double base_distance() const { return b.shoulder_x - a.shoulder_x; }
};

/// Derives the geometry of one leg from the joint frames of `robot`.
/// @throws ConfigError naming the joint if the leg is not a five-bar on a tilt joint: the tilt axis along x
/// of the
///   base; shoulder and elbow axes along y at zero tilt; both shoulders at one height, shoulder_left behind
///   shoulder_right; the lower links joined by a loop closure at the foot's centre.
FiveBarGeometry five_bar_geometry(const RobotDescription& robot, Leg leg);

/// `five_bar_geometry` of all legs.
LegArray<FiveBarGeometry> five_bar_geometry(const RobotDescription& robot);

/// p_BL of every leg: where gaits and velocity commands take the legs to be, m.
LegArray<Vector3> leg_origins(const LegArray<FiveBarGeometry>& legs);

/// @throws ConfigError (naming `source`) unless lengths are positive and the chains can meet everywhere
/// between the
///   two shoulders' reach, which `clamp_to_workspace` relies on.
void validate(const FiveBarGeometry& geometry, const std::string& source);

}  // namespace crossgait
