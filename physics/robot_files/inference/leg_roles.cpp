#include "physics/robot_files/inference/leg_roles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "physics/core/across_axis.h"
#include "physics/robot_files/inference/shape_outline.h"

namespace crossgait {
namespace {

constexpr double kOneDirection = 0.8;  // cosine of the largest angle between axes of one direction
constexpr double kRound = 0.7;         // of a wheel's radius: the least that it reaches in any direction
constexpr int kDirections = 8;
constexpr double kOffCentre = 0.3;    // of a wheel's radius: its middle off its axis
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
    for (const CollisionShape& shape : body.shapes) {
      for (const Vector3& p : outline_of(robot, shape))
        reach = std::max(reach, std::abs(direction.dot(p - middle)) + rounding_of(robot, shape));
    }
    most = std::max(most, reach);
    least = std::min(least, reach);
  }
  if (least < kRound * most || across(middle, axis).norm() > kOffCentre * most) return std::nullopt;
  const Wheel wheel{middle, most};
  return wheel;
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
  for (const int joint : joints) {
    const bool has_role = joint == hip || joint == knee || joint == abduction;
    const bool is_ankle = is_behind && !has_ankle && tree.follows(joint);
    const bool follows = is_ankle || (joint == knee && knee_follows);
    (follows ? leg.followers : has_role ? leg.servos : leg.held).push_back(joint);
    has_ankle |= is_ankle;
    is_behind |= joint == knee;
  }
  if (abduction >= 0 && leg.servos.front() == hip) leg.linkage = LegLinkage::kHipFirst;
  if (knee_follows) leg.linkage = LegLinkage::kKneeFollows;
  return leg.held.size() > kMostHeld ? std::nullopt : std::optional(leg);
}

}  // namespace crossgait
