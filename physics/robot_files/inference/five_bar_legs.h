// Five-bars: legs of two chains that a loop joins at the foot. Private to inference.
#pragma once

#include <optional>

#include "physics/robot_files/inference/leg_frame.h"

namespace crossgait {

/// Finds four of them by the loops of the file: each joins the ends of two chains of shoulder and elbow that
/// hang on the base, or on one joint of it, the tilt; all four alike in that, the four axes of each parallel.
/// @returns nothing where four loops do not make four such legs
std::optional<FoundLegs> five_bars_of(const JointTree& tree);

/// Makes the chain that is behind the left one (conventions.md). Of shoulders on one axis it is the one whose
/// elbow is behind with the shoulder at the file's home, else in the middle of its limits.
/// @param R_BA  columns: forward, left and up of the robot in the file's base frame
void put_left_behind(const JointTree& tree, const Matrix3& R_BA, LegJoints& joints);

}  // namespace crossgait
