// Where a robot's hips are: places and lengths that are the robot's own, wherever its file has the base's
// frame.
#pragma once

#include "physics/robot/robot.h"

namespace crossgait {

/// Returns where the hip of each leg is in the home pose, between its shoulders that of a five-bar, in the
/// base's frame, m. Requires legs.
LegArray<Vector3> hip_places(const RobotDescription& robot);

/// Returns the middle of them, m: a point of the base. Of a robot without legs the base's origin.
Vector3 hip_middle(const RobotDescription& robot);

/// Describes how the hips lie in the base's frame: front, rear, left and right.
struct HipFrame {
  Vector3 middle;           ///< m
  double roll, pitch, yaw;  ///< of the way from rear to front and from right to left, rad
};
/// Requires legs.
HipFrame hip_frame(const RobotDescription& robot);

/// Returns the leg length, m: the height of that middle over flat ground in the home pose.
double leg_length(const RobotDescription& robot);

}  // namespace crossgait
