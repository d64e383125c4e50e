#include "physics/robot_files/inference/leg_tree.h"

#include <algorithm>
#include <utility>

#include "physics/robot_files/inference/shape_outline.h"

namespace crossgait {

JointTree::JointTree(const ParsedRobot& robot)
    : robot_(robot), poses_(robot.bodies.size(), Pose::Identity()) {
  for (std::size_t i = 1; i < robot.bodies.size(); ++i) {
    const Body& body = robot.bodies[i];
    poses_[i] = poses_[static_cast<std::size_t>(body.parent)] * body.X_PB;
    const auto angle = robot.drawn_at.find(body.joint.name);
    if (angle != robot.drawn_at.end())
      poses_[i] = poses_[i] * Eigen::AngleAxisd(angle->second, body.joint.axis);
  }
  for (const Body& body : robot.bodies) follows_.push_back(crossgait::follows(robot, body.joint.name));
  is_moved_by_loop_.resize(robot.bodies.size(), false);
  find_twigs();
  find_bars();
}

std::vector<int> JointTree::way_to(int body) const {
  std::vector<int> way;
  for (int i = body; i > 0; i = this->body(i).parent) way.insert(way.begin(), i);
  return way;
}

bool JointTree::hangs_on(int body, int on) const {
  for (int i = body; i > 0; i = this->body(i).parent) {
    if (i == on) return true;
  }
  return false;
}

double JointTree::reach_of(int root, const Vector3& from, int excluded) const {
  double reach = 0;
  const auto counts = [&](int i) { return hangs_on(i, root) && !(excluded > 0 && hangs_on(i, excluded)); };
  const auto look = [&](int i, const Vector3& p, double radius) {
    const Vector3 placed = poses_[static_cast<std::size_t>(i)] * p;
    reach = std::max(reach, (placed - from).norm() + radius);
  };
  for (int i = root; i < static_cast<int>(robot_.bodies.size()); ++i) {
    if (!counts(i)) continue;
    look(i, Vector3::Zero(), 0);
    for (const CollisionShape& shape : body(i).shapes) {
      for (const Vector3& p : outline_of(robot_, shape)) look(i, p, rounding_of(robot_, shape));
    }
  }
  const auto look_at_link = [&](const std::string& name, const Vector3& p) {
    const auto link = robot_.links.find(name);
    if (link != robot_.links.end() && counts(link->second.body))
      look(link->second.body, link->second.X_BL * p, 0);
  };
  for (const auto& [name, link] : robot_.links) look_at_link(name, Vector3::Zero());
  for (const LinkLoop& loop : robot_.loops) {
    look_at_link(loop.link_a, loop.p_a);
    look_at_link(loop.link_b, loop.p_b);
  }
  return reach;
}

std::optional<Vector3> JointTree::point_of(const std::string& link, const Vector3& p) const {
  const auto found = robot_.links.find(link);
  if (found == robot_.links.end()) return std::nullopt;
  return poses_[static_cast<std::size_t>(found->second.body)] * (found->second.X_BL * p);
}

bool JointTree::reach_alike(int a, int b) const {
  constexpr double kAlike = 0.9;
  const double of_a = reach_of(a), of_b = reach_of(b);
  return std::min(of_a, of_b) > kAlike * std::max(of_a, of_b);
}

void JointTree::find_bars() {
  // More than any robot that is simulated has, with all that is held of it: files that are no robots are
  // refused elsewhere, and soon.
  constexpr std::size_t kMostBodies = 512, kMostLoops = 64;
  if (robot_.bodies.size() > kMostBodies || robot_.loops.size() > kMostLoops) return;
  for (const LinkLoop& loop : robot_.loops) {
    const auto a = robot_.links.find(loop.link_a), b = robot_.links.find(loop.link_b);
    if (a == robot_.links.end() || b == robot_.links.end()) continue;
    std::vector<int> bar = way_to(a->second.body), leg = way_to(b->second.body);
    bool is_in_a_branch = false;
    while (!bar.empty() && !leg.empty() && bar.front() == leg.front()) {
      is_in_a_branch = true;
      bar.erase(bar.begin());
      leg.erase(leg.begin());
    }
    if (!is_in_a_branch && !bar.empty() && !leg.empty() && reach_alike(bar.front(), leg.front()))
      continue;  // two legs
    if (leg.empty() || (!bar.empty() && reach_of(bar.front()) > reach_of(leg.front()))) std::swap(bar, leg);
    if (leg.empty()) continue;  // a link joined to itself
    const std::vector<int> rods = take_rods(leg);
    std::vector<int> roots;
    for (const std::vector<int>* way : {&std::as_const(bar), &rods}) {
      if (!way->empty()) roots.push_back(way->front());
    }
    bar.insert(bar.end(), rods.rbegin(), rods.rend());
    move_by_loop(bar, leg);
    Bar found{{}, leg};
    for (int i = 1; i < static_cast<int>(robot_.bodies.size()); ++i) {
      if (std::ranges::none_of(roots, [&](int root) { return hangs_on(i, root); })) continue;
      is_twig_[static_cast<std::size_t>(i)] = true;
      found.bodies.push_back(i);
    }
    if (!found.bodies.empty()) bars_.push_back(std::move(found));
  }
}

std::vector<int> JointTree::take_rods(std::vector<int>& leg) const {
  std::vector<int> rods;
  const Vector3 from = origin(leg.front());
  while (leg.size() > 1) {
    const int last = leg.back();
    if (reach_of(last, from, -1) >= reach_of(leg[leg.size() - 2], from, last)) break;
    rods.insert(rods.begin(), last);
    leg.pop_back();
  }
  return rods;
}

void JointTree::move_by_loop(const std::vector<int>& bar, const std::vector<int>& leg) {
  constexpr int kPlanar = 2;  // joints that a loop in a plane moves
  const bool by_file = !robot_.servos.empty();
  const std::ptrdiff_t cranks = !by_file && bar.size() > 1 ? 1 : 0;
  std::vector<int> last_first(bar.rbegin(), bar.rend() - cranks);
  last_first.insert(last_first.end(), leg.rbegin(), leg.rend());
  int moved = 0;
  for (const int i : last_first) {
    if (follows(i)) continue;
    if (by_file ? robot_.servos.contains(joint(i).name) : moved == kPlanar) continue;
    is_moved_by_loop_[static_cast<std::size_t>(i)] = true;
    ++moved;
  }
}

std::vector<int> JointTree::bars_of(const std::vector<int>& bodies) const {
  std::vector<int> known = bodies, found;
  const auto is_known = [&known](int i) { return std::ranges::find(known, i) != known.end(); };
  for (std::size_t round = 0; round < bars_.size(); ++round) {
    for (const Bar& bar : bars_) {
      if (std::ranges::none_of(bar.beside, is_known)) continue;
      for (const int i : bar.bodies) {
        if (is_known(i)) continue;
        known.push_back(i);
        found.push_back(i);
      }
    }
  }
  std::ranges::sort(found);
  return found;
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
