// What to make of inertia that no real body has.
#pragma once

#include <string_view>
#include <vector>

#include "physics/robot/robot.h"

namespace crossgait {

/// Gives a body of positive mass the inertia of a real body where it has none:
///  - all zero (a radius of gyration below a micrometre): that of the bounding box of its shapes, or of a
///  solid
///    sphere of water if it has none;
///  - a principal moment that is not positive, or larger than the sum of the other two: the smaller moments
///    are raised until they are a thousandth above what the largest needs.
/// What is out of bounds, not finite or wholly negative stays, for `check_inertia` to refuse.
/// @returns what was wrong and was done, for a list of bodies: "... bodies: "; empty for nothing
std::string_view repair_inertia(SpatialInertia& inertia, const std::vector<CollisionShape>& shapes);

}  // namespace crossgait
