#include "physics/robot/loop_gap.h"

#include <algorithm>
#include <cmath>

namespace crossgait {
namespace {

// Bodies come after their parents, so the larger index is never an ancestor of the smaller.
int common_ancestor(const RobotDescription& robot, int a, int b) {
  while (a != b) {
    int& outer = a > b ? a : b;
    outer = robot.bodies[static_cast<std::size_t>(outer)].parent;
  }
  return a;
}

}  // namespace

LoopGaps::LoopGaps(const RobotDescription& robot) {
  for (const LoopClosure& loop : robot.loops) {
    const int ancestor = common_ancestor(robot, loop.body_a, loop.body_b);
    loops_.push_back(
        {end_of(robot, loop.body_a, ancestor, loop.p_AP), end_of(robot, loop.body_b, ancestor, loop.p_BP)});
  }
}

LoopGaps::End LoopGaps::end_of(const RobotDescription& robot, int body, int ancestor, const Vector3& point) {
  End end{point, {}};
  for (int i = body; i != ancestor; i = robot.bodies[static_cast<std::size_t>(i)].parent) {
    const Body& b = robot.bodies[static_cast<std::size_t>(i)];
    end.links.push_back({b.X_PB.linear(), b.X_PB.translation(), b.joint.axis, i - 1});
  }
  return end;
}

Vector3 LoopGaps::position(const End& end, const JointVector& q) noexcept {
  Vector3 p = end.point;
  for (const Link& link : end.links) {
    // Rodrigues' formula, for one vector.
    const double angle = q[link.joint], s = std::sin(angle), c = std::cos(angle);
    const Vector3 turned = c * p + s * link.axis.cross(p) + (1 - c) * link.axis.dot(p) * link.axis;
    p = link.p + link.R * turned;
  }
  return p;
}

double LoopGaps::largest(const JointVector& q) const noexcept {
  double gap = 0;
  for (const Loop& loop : loops_) gap = std::max(gap, (position(loop.a, q) - position(loop.b, q)).norm());
  return gap;
}

}  // namespace crossgait
