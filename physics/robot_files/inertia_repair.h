// What links may weigh, and what to make of inertia that no real body has.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "physics/robot/robot.h"
#include "physics/robot_files/reader_warnings.h"

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

/// Checks what a link may add to its body; whether the body is possible is seen when it is whole.
/// @param I  about its centre of mass, kg m^2 @throws ConfigError naming `source` and `element`
void check_part(double mass, const Matrix3& I, const std::string& source, const std::string& element,
                ReaderWarnings& warnings);

/// Repairs and checks the inertia of a body with all that is fixed to it. @param has_inertial  whether its
/// own link says any @throws ConfigError naming `source` and `element`
void check_whole(Body& body, bool has_inertial, const std::string& source, const std::string& element,
                 ReaderWarnings& warnings);

}  // namespace crossgait
