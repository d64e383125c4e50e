// Principal axes of a body's inertia, so that every engine is given the same diagonal inertia in the same
// frame.
#pragma once

#include "physics/robot/robot.h"

namespace crossgait {

struct PrincipalInertia {
  Pose X_BP = Pose::Identity();       ///< frame at the centre of mass along the principal axes
  Vector3 moments = Vector3::Zero();  ///< about those axes, kg m^2
};

/// A diagonal inertia keeps the body's axes (and its exact numbers); others are diagonalised.
PrincipalInertia principal_inertia(const SpatialInertia& inertia);

/// Inverts `principal_inertia`: mass properties in the body frame.
SpatialInertia from_principal(double mass, const PrincipalInertia& principal);

}  // namespace crossgait
