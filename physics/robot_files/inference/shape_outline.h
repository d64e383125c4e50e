// Points of a body's shapes among which is its farthest from anywhere. Private to inference.
#pragma once

#include <array>
#include <vector>

#include "physics/robot_files/parsed_robot.h"

namespace crossgait {

/// Returns the ends of a cylinder's axis, or of a capsule's, in the body's frame, m.
std::array<Vector3, 2> ends_of(const CollisionShape& shape);

/// Returns a mesh's or hull's vertices, a box's corners, the ends of the axis of a cylinder or capsule (a
/// foot touches with its middle), a sphere's centre; in the body's frame, m.
std::vector<Vector3> outline_of(const ParsedRobot& robot, const CollisionShape& shape);

/// Says how far a shape reaches from its outline: a sphere's, cylinder's or capsule's radius, 0 of others, m.
double rounding_of(const ParsedRobot& robot, const CollisionShape& shape);

/// Returns how far a shape reaches from a point along a unit vector, either way, m; exactly of cylinders,
/// too.
double reach_of(const ParsedRobot& robot, const CollisionShape& shape, const Vector3& point,
                const Vector3& direction);

}  // namespace crossgait
