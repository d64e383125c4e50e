// Coulomb friction on inclines: a sled sticks on one side of the friction cone and slides on the other, in
// every heading alike.
#pragma once

#include "physics/engine/engine.h"
#include "scenes/scenes.h"

namespace crossgait::scenes {

/// Holds a world of the sled with an incline, and how its surface lies in W.
struct Incline {
  WorldSpec spec;
  Vector3 normal, downhill;
};

/// Climbs by `angle` towards `heading`, rad.
using MakeIncline = Incline (*)(double angle, double heading);
/// Makes the plane, under tilted gravity.
Incline tilted_gravity(double angle, double heading);
/// Makes a height field of plane triangles, under upright gravity.
Incline inclined_field(double angle, double heading);

inline constexpr double kInclineFriction = 0.6;

/// Returns the angle at which the friction coefficient is `friction_over_tangent` times tan(angle), rad.
double incline_angle(double friction_over_tangent);

/// Holds what the sled did on an incline on either side of the friction cone: the worst over eight headings.
/// It is let go, given 0.2 s to settle and watched for 0.3 s, in steps of 1 ms.
struct FrictionCone {
  /// A tenth inside, where it should stick.
  double creep_speed = 0;     ///< m/s
  double creep_distance = 0;  ///< m
  /// A tenth outside, where it should go a t^2 / 2, a = g (sin - mu cos).
  double distance_error = 0;  ///< relative
  double range = 0;           ///< of the distance over the headings, relative
  double off_line = 0;        ///< off the line of fall, share of the distance
};
inline constexpr double kInclineSeconds = 0.3;                  ///< that it is watched
inline constexpr double kJustInside = 1.1, kJustOutside = 0.9;  ///< friction over tan(angle)

/// @throws std::runtime_error if the engine diverges
FrictionCone measure_friction_cone(const Engine& engine, MakeIncline make_incline);

}  // namespace crossgait::scenes
