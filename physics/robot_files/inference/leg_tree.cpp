#include "physics/robot_files/inference/leg_tree.h"

#include <algorithm>

namespace crossgait {

JointTree::JointTree(const ParsedRobot& robot)
    : robot_(robot), poses_(robot.bodies.size(), Pose::Identity()) {
  for (std::size_t i = 1; i < robot.bodies.size(); ++i)
    poses_[i] = poses_[static_cast<std::size_t>(robot.bodies[i].parent)] * robot.bodies[i].X_PB;
}

std::size_t JointTree::children_of(int body) const {
  return static_cast<std::size_t>(
      std::ranges::count_if(robot_.bodies, [body](const Body& other) { return other.parent == body; }));
}

std::vector<JointChain> JointTree::branches() const {
  std::vector<JointChain> all;
  std::vector<std::size_t> of(robot_.bodies.size(), 0);  // the branch that each body belongs to
  for (std::size_t i = 1; i < robot_.bodies.size(); ++i) {
    const auto parent = static_cast<std::size_t>(robot_.bodies[i].parent);
    of[i] = parent == 0 ? all.size() : of[parent];
    if (parent == 0) all.push_back({{}, 0, 0});
    JointChain& branch = all[of[i]];
    branch.bodies.push_back(static_cast<int>(i));
    branch.tips += children_of(static_cast<int>(i)) == 0 ? 1 : 0;
  }
  return all;
}

std::vector<JointChain> JointTree::ends() const {
  std::vector<JointChain> all;
  for (int tip = 1; tip < static_cast<int>(robot_.bodies.size()); ++tip) {
    if (children_of(tip) > 0) continue;
    JointChain chain{{tip}, body(tip).parent, 1};
    while (chain.parent > 0 && children_of(chain.parent) == 1) {
      chain.bodies.insert(chain.bodies.begin(), chain.parent);
      chain.parent = body(chain.parent).parent;
    }
    all.push_back(std::move(chain));
  }
  return all;
}

}  // namespace crossgait
