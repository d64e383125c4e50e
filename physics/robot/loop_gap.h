// How far the loops of a robot gape, at the cost of the loops' own joints alone.
#pragma once

#include <vector>

#include "physics/robot/robot.h"
#include "physics/robot/state.h"

namespace crossgait {

/// Reads the loops of a robot once; the robot need not outlive it. The same gaps as `max_loop_gap` of all
/// poses, computed in the frame of the last body that both ends of a loop hang on.
class LoopGaps {
 public:
  explicit LoopGaps(const RobotDescription& robot);

  /// Returns the largest distance between the two points of any loop closure, m; 0 without loops.
  double largest(const JointVector& q) const noexcept;

 private:
  struct Link {
    Matrix3 R;        // of the joint's frame in its parent at zero angle
    Vector3 p, axis;  // joint's origin in its parent, m; unit axis in its own frame
    Eigen::Index joint;
  };
  struct End {
    Vector3 point = Vector3::Zero();  // in the outermost body, m
    std::vector<Link> links;          // from the outermost body inwards
  };
  struct Loop {
    End a, b;
  };
  static End end_of(const RobotDescription& robot, int body, int ancestor, const Vector3& point);
  static Vector3 position(const End& end, const JointVector& q) noexcept;

  std::vector<Loop> loops_;
};

}  // namespace crossgait
