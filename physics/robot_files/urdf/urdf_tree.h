// Changes of a URDF's tree before a robot is made of it.
#pragma once

#include <set>
#include <string>

#include "physics/robot_files/urdf/urdf_reader.h"

namespace crossgait {

/// Fixes joints at zero angle: what they move becomes part of what they hang on. @param joints  their names
UrdfRobot lock_joints(UrdfRobot robot, const std::set<std::string>& joints);

/// Turns the base's own axes: what was along `R` x of the base is along x afterwards. @param R_BA  rotation
/// whose columns are the new forward, left and up in the file's base frame
UrdfRobot turn_base(UrdfRobot robot, const Matrix3& R_BA);

}  // namespace crossgait
