#include "physics/robot_files/inference/leg_tree.h"

#include <algorithm>

namespace crossgait {

JointTree::JointTree(const ParsedRobot& robot)
    : robot_(robot), poses_(robot.bodies.size(), Pose::Identity()) {
  for (std::size_t i = 1; i < robot.bodies.size(); ++i)
    poses_[i] = poses_[static_cast<std::size_t>(robot.bodies[i].parent)] * robot.bodies[i].X_PB;
  for (const Body& body : robot.bodies) follows_.push_back(crossgait::follows(robot, body.joint.name));
  find_twigs();
}

void JointTree::find_twigs() {
  // Bodies come after their parents: whether all that hangs on one follows is known before the body itself.
  std::vector<bool> only_follows = follows_;
  for (std::size_t i = robot_.bodies.size() - 1; i > 0; --i) {
    const auto parent = static_cast<std::size_t>(robot_.bodies[i].parent);
    if (!only_follows[i]) only_follows[parent] = false;
  }
  is_twig_.resize(robot_.bodies.size(), false);
  for (std::size_t i = 1; i < robot_.bodies.size(); ++i) {
    const int parent = robot_.bodies[i].parent;
    bool has_other = false;
    for (std::size_t k = 1; k < robot_.bodies.size(); ++k)
      has_other |= robot_.bodies[k].parent == parent && !only_follows[k];
    is_twig_[i] = is_twig_[static_cast<std::size_t>(parent)] || (parent > 0 && only_follows[i] && has_other);
  }
}

std::size_t JointTree::children_of(int body) const {
  std::size_t count = 0;
  for (std::size_t i = 1; i < robot_.bodies.size(); ++i)
    count += robot_.bodies[i].parent == body && !is_twig_[i] ? 1 : 0;
  return count;
}

std::vector<JointChain> JointTree::branches() const {
  std::vector<JointChain> all;
  std::vector<std::size_t> of(robot_.bodies.size(), 0);  // the branch that each body belongs to
  for (std::size_t i = 1; i < robot_.bodies.size(); ++i) {
    if (is_twig_[i]) continue;
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
    if (is_twig_[static_cast<std::size_t>(tip)] || children_of(tip) > 0) continue;
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
