// Checks behind RobotDescription::validate, one by one for readers that know a better place to point at.
// All throw ConfigError(source, element, ...).
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "crossgait/physics/robot.h"

namespace crossgait {

/// Loops count as closed at home when no gap exceeds this, m.
inline constexpr double kHomeLoopTolerance = 1e-9;

/// A joint of a leg: its member of LegModel, and that of the joint it hangs on (null: on the base).
struct LegRole {
  const char* name;
  int LegModel::*joint;
  int LegModel::*parent;
  bool actuated;
};
/// In the order of joints within a leg.
inline constexpr std::array<LegRole, 5> kLegRoles{
    {{"tilt", &LegModel::tilt, nullptr, true},
     {"shoulder_left", &LegModel::shoulder_left, &LegModel::tilt, true},
     {"shoulder_right", &LegModel::shoulder_right, &LegModel::tilt, true},
     {"elbow_left", &LegModel::elbow_left, &LegModel::shoulder_left, false},
     {"elbow_right", &LegModel::elbow_right, &LegModel::shoulder_right, false}}};

/// Positive mass; inertia finite, symmetric, positive definite and that of some real body: none of its
/// principal moments exceeds the sum of the other two.
void check_inertia(const SpatialInertia& inertia, std::string_view source, std::string_view element);
/// Finite, positive sizes and a proper pose.
void check_shape(const CollisionShape& shape, std::string_view source, std::string_view element);
/// Unit axis, ordered limits, and damping, armature and servo gains that are not negative.
void check_joint(const Joint& joint, std::string_view source);
/// Everything about a robot except its home pose.
void check_structure(const RobotDescription& robot);
/// Sizes, limits and loops of the home pose. Requires a checked structure.
void check_home(const RobotDescription& robot);

}  // namespace crossgait
