#include "physics/robot_files/inference/leg_roles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "physics/core/across_axis.h"
#include "physics/robot_files/inference/shape_outline.h"

namespace crossgait {
namespace {

constexpr double kOneDirection = 0.8;  // cosine of the largest angle between axes of one direction
// Of a wheel's radius: the least that it reaches in any direction. A hexagon has 0.87, a square 0.71.
constexpr double kRound = 0.85;
constexpr int kDirections = 8;
constexpr double kOffCentre = 0.1;    // of a wheel's radius: its middle off its axis
constexpr double kWholeTurn = 6.283;  // rad, of limits that are none
constexpr std::size_t kMostHeld = 2;

bool are_parallel(const Vector3& a, const Vector3& b) { return std::abs(a.dot(b)) > kOneDirection; }

/// The joints of the chain that are parallel to one of them, of most; of equally many those that follow each
/// other, as hip and knee do and abduction and a rolling ankle do not; else the last ones.
std::vector<int> in_one_plane(const JointTree& tree, const std::vector<int>& chain) {
  const auto is_in_a_row = [&](const std::vector<int>& joints) {
    return joints.size() > 1 && tree.body(joints[1]).parent == joints[0];
  };
  std::vector<int> most;
  for (const int one : chain) {
    std::vector<int> parallel;
    std::ranges::copy_if(chain, std::back_inserter(parallel),
                         [&](int other) { return are_parallel(tree.axis(one), tree.axis(other)); });
    const bool is_better = parallel.size() == most.size() ? is_in_a_row(parallel) || !is_in_a_row(most)
                                                          : parallel.size() > most.size();
    if (is_better) most = std::move(parallel);
  }
  return most;
}

}  // namespace

std::optional<Wheel> wheel_of(const ParsedRobot& robot, int index) {
  const Body& body = robot.bodies[static_cast<std::size_t>(index)];
  if (body.joint.upper - body.joint.lower < kWholeTurn) return std::nullopt;
  Vector3 middle = Vector3::Zero();
  std::size_t count = 0;
  for (const CollisionShape& shape : body.shapes) {
    for (const Vector3& p : outline_of(robot, shape)) middle += (p - middle) / static_cast<double>(++count);
  }
  if (count == 0) return std::nullopt;
  // Of a wheel every direction across the axis is as long as any other; a shin is long in one of them.
  const Vector3& axis = body.joint.axis;
  const Vector3 first = axis.unitOrthogonal(), second = axis.cross(first);
  double most = 0, least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kDirections; ++i) {
    const double angle = M_PI * i / kDirections;
    const Vector3 direction = std::cos(angle) * first + std::sin(angle) * second;
    double reach = 0;
    for (const CollisionShape& shape : body.shapes)
      reach = std::max(reach, reach_of(robot, shape, middle, direction));
    most = std::max(most, reach);
    least = std::min(least, reach);
  }
  if (least < kRound * most || across(middle, axis).norm() > kOffCentre * most) return std::nullopt;
  const Wheel wheel{middle, most};
  return wheel;
}

int LegJoints::knee() const {
  if (linkage == LegLinkage::kClosedChain) {
    const auto place = static_cast<std::size_t>(std::ranges::find(parts, LegPart::kKnee) - parts.begin());
    return place < servos.size() ? servos[place] : followers[place - servos.size()];
  }
  return linkage == LegLinkage::kKneeFollows ? followers.front() : servos.back();
}

std::optional<LegJoints> closed_chain_of(const JointTree& tree,
                                         const std::vector<std::pair<LegPart, int>>& chain) {
  std::vector<int> bodies;
  bool is_closed = false, has_follower = false;
  for (const auto& [part, body] : chain) {
    bodies.push_back(body);
    is_closed |= tree.is_moved_by_loop(body) || (has_follower && !tree.follows(body));
    has_follower |= part == LegPart::kKnee && tree.follows(body);
  }
  std::vector<std::pair<LegPart, int>> all = chain;
  for (const int bar : tree.bars_of(bodies)) all.emplace_back(LegPart::kBar, bar);
  if (!is_closed && all.size() == chain.size()) return std::nullopt;
  LegJoints leg;
  leg.linkage = LegLinkage::kClosedChain;
  for (const bool follows : {false, true}) {
    for (const auto& [part, body] : all) {
      if (tree.follows(body) != follows) continue;
      (follows ? leg.followers : leg.servos).push_back(body);
      leg.parts.push_back(part);
    }
  }
  return leg;
}

std::optional<LegJoints> roles_of(const JointTree& tree, const JointChain& chain, const Vector3& up) {
  LegJoints leg;
  std::vector<int> joints = chain.bodies;
  if (wheel_of(tree.robot(), joints.back())) {
    leg.held.push_back(joints.back());
    joints.pop_back();
  }
  const std::vector<int> plane = in_one_plane(tree, joints);
  if (plane.size() < 2) return std::nullopt;
  const int hip = plane[0], knee = plane[1];
  int abduction = -1;
  for (const int joint : joints) {
    if (joint == knee) break;
    if (std::ranges::find(plane, joint) != plane.end()) continue;
    const auto about_up = [&](int j) { return std::abs(tree.axis(j).dot(up)); };
    if (abduction < 0 || about_up(joint) < about_up(abduction)) abduction = joint;
  }
  const bool knee_follows = abduction >= 0 && tree.follows(knee);
  bool has_ankle = false, is_behind = false;
  std::vector<std::pair<LegPart, int>> parts;
  for (const int joint : joints) {
    const bool has_role = joint == hip || joint == knee || joint == abduction;
    // Behind a knee that follows, what has a servo moves the foot in the place of the knee.
    const bool stands_in =
        knee_follows && !tree.is_moved_by_loop(knee) && std::ranges::find(plane, joint) != plane.end();
    const bool is_ankle = is_behind && !has_ankle && (tree.follows(joint) || stands_in);
    const bool follows = (is_ankle && tree.follows(joint)) || (joint == knee && knee_follows);
    (follows ? leg.followers : has_role || is_ankle ? leg.servos : leg.held).push_back(joint);
    if (has_role || is_ankle)
      parts.emplace_back(joint == hip    ? LegPart::kHip
                         : joint == knee ? LegPart::kKnee
                         : is_ankle      ? LegPart::kAnkle
                                         : LegPart::kAbduction,
                         joint);
    has_ankle |= is_ankle;
    is_behind |= joint == knee;
  }
  if (leg.held.size() > kMostHeld) return std::nullopt;
  if (auto closed = closed_chain_of(tree, parts)) {
    if (closed->servos.size() < 2) return std::nullopt;  // loops move all that it has: they join two legs
    closed->held = leg.held;
    return closed;
  }
  if (abduction >= 0 && leg.servos.front() == hip) leg.linkage = LegLinkage::kHipFirst;
  if (knee_follows) leg.linkage = LegLinkage::kKneeFollows;
  return leg;
}

}  // namespace crossgait
