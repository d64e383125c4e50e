// The box around a collision shape.
#pragma once

#include "physics/robot/robot.h"

namespace crossgait {

/// Returns the smallest box along the axes of the shape's body that holds the shape, m.
Eigen::AlignedBox3d box_around(const CollisionShape& shape);

}  // namespace crossgait
