// Checks behind RobotDescription::validate, one by one for readers that know a better place to point at.
// All throw ConfigError(source, element, ...).
#pragma once

#include <string>
#include <string_view>

#include "physics/robot/robot.h"

namespace crossgait {

/// Followers are where they belong at home when they are as near as this, rad.
inline constexpr double kHomeCouplingTolerance = 1e-9;

/// What a robot may be made of; beyond, engines' arithmetic breaks down long before anything walks, and a
/// wrong unit or exponent is the likelier meaning.
inline constexpr double kLightestBody = 1e-9, kHeaviestBody = 1e6;  ///< kg
inline constexpr double kLargestInertia = 1e9;                      ///< kg m^2, also of armatures
inline constexpr double kLargestLength = 1e3;                       ///< m, of shapes and of every offset
inline constexpr double kLargestGain = 1e9;   ///< N m/rad, N m s/rad and N m: servo gains, damping, torques
inline constexpr double kLargestAngle = 1e6;  ///< rad, of joint limits
inline constexpr double kLongestDelay = 1;    ///< s, of a drive

/// Checks mass, offset and inertia within the limits above; inertia finite, symmetric, positive definite and
/// that of some real body: none of its principal moments exceeds the sum of the other two.
void check_inertia(const SpatialInertia& inertia, std::string_view source, std::string_view element);
/// Checks positive sizes or a hull's vertices, and a proper pose, within the limits above.
void check_shape(const CollisionShape& shape, std::string_view source, std::string_view element);
/// Checks unit axis, ordered limits, and damping, friction, armature and servo gains that are not negative.
void check_joint(const Joint& joint, std::string_view source);
/// Checks that every number of a robot, whichever it is, is finite: what the other checks do not look at too.
void check_finite(const RobotDescription& robot);
/// Checks everything about a robot except its home pose.
void check_structure(const RobotDescription& robot);
/// Checks sizes, limits, loops and couplings of the home pose. Requires a checked structure.
void check_home(const RobotDescription& robot);

}  // namespace crossgait
