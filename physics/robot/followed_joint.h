// Who leads a joint that follows others, along a chain of couplings.
#pragma once

#include <span>

#include "physics/robot/robot.h"

namespace crossgait {

struct FollowedJoint {
  int joint = -1;  ///< at which the walk ended: one of those asked for, or one that follows nobody
  bool is_one_of_them = false;  ///< of those asked for
  bool in_a_circle = false;     ///< the walk has no end
  double multiplier = 1,
         offset = 0;  ///< the follower's angle is multiplier times that joint's plus offset, rad
  const JointCoupling* not_linear = nullptr;  ///< the first coupling on the way of which that is not true
};

/// Walks from a joint to what leads it, to what leads that and so on, up to the first that is one of `ends`,
/// itself included.
FollowedJoint follow_couplings(const RobotDescription& robot, int joint, std::span<const int> ends);

}  // namespace crossgait
