// The joint frames of one leg at zero joint angles, for what derives a leg's geometry from a robot, and the
// errors it raises.
#pragma once

#include <string>

#include "ik/two_link_chain.h"
#include "physics/robot/leg.h"
#include "physics/robot/robot.h"

namespace crossgait {

/// Names an element of one leg in messages, and finds its frames at zero joint angles. The robot must outlive
/// it.
class LegFrames {
 public:
  /// @param aligned  largest misalignment of an axis that still counts as none, rad
  LegFrames(const RobotDescription& robot, Leg leg, double aligned)
      : robot_(robot), leg_(leg), aligned_(aligned) {}

  /// @throws ConfigError naming the robot's file, the leg and `what`
  [[noreturn]] void fail(std::string_view what, const std::string& expected, const std::string& found) const;

  /// Returns the pose of the body that joint `joint` moves, in the base frame, at zero joint angles.
  Pose pose(int joint) const;

  /// Tells whether the axis of joint `joint` is parallel to the unit vector `direction` of the base frame.
  bool is_along(int joint, const Vector3& direction) const;

  /// Returns a joint axis' sign along `direction` (base frame). @throws ConfigError unless they are parallel
  double axis_sign(int joint, const Vector3& direction, std::string_view along) const;

  /// @throws ConfigError unless the body of `joint` hangs on `parent_body`
  void require_parent(int joint, int parent_body) const;

  /// @param what  role of the joint, for the message
  /// @throws ConfigError unless the robot has a joint of this index
  void require_joint(int joint, std::string_view what) const;

  JointLimits limits(int joint) const { return {robot_.joint(joint).lower, robot_.joint(joint).upper}; }

  const Body& at(int body) const { return robot_.bodies[static_cast<std::size_t>(body)]; }

 private:
  Vector3 axis(int joint) const { return pose(joint).linear() * robot_.joint(joint).axis; }

  const RobotDescription& robot_;
  Leg leg_;
  double aligned_;
};

/// Returns lengths, zero directions, signs and limits of the chain of two joints about y that ends at `tip`
/// (in the frame of the second joint's body, m): everything but `shoulder_x`. @throws ConfigError if the axes
/// do not fit
TwoLinkChain two_link_chain(const LegFrames& frames, int shoulder, int elbow, const Vector3& tip);

}  // namespace crossgait
