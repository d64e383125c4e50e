#include <array>
#include <cmath>

#include <fmt/format.h>

#include "scenes/robot_pieces.h"
#include "scenes/robots.h"

namespace crossgait::scenes {
namespace {

constexpr double kUpper = 0.1, kLower = 0.2, kStands = 0.22;  // m

/// Angles about +y of upper and lower link from straight down, with the tip `aside` (along x) and kStands
/// below.
std::array<double, 2> link_angles(double aside, double elbow_side) {
  const double r = std::hypot(aside, kStands), to_foot = std::atan2(-aside, kStands);
  const double open = std::acos((r * r + kUpper * kUpper - kLower * kLower) / (2 * r * kUpper));
  const double upper = to_foot - elbow_side * open;
  const double x = aside + kUpper * std::sin(upper), z = -kStands + kUpper * std::cos(upper);
  return {upper, std::atan2(-x, -z)};
}

void add_planar_five_bar(RobotDescription& robot, Leg leg, double apart) {
  LegModel& model = (*robot.legs)[leg];
  model.linkage = LegLinkage::kFiveBar;
  const int first = robot.joint_count();
  model.servos = {first, first + 1};
  model.passive = {first + 2, first + 3};
  for (int i = 0; i < 4; ++i) {
    const bool is_upper = i < 2, is_left = i % 2 == 0;
    const double length = is_upper ? kUpper : kLower;
    Body body = free_body(
        fmt::format("{}_{}_{}", name(leg), is_upper ? "upper" : "lower", is_left ? "left" : "right"),
        {0.05, {0, 0, -length / 2}, Vector3(2e-4, 2e-4, 1e-5).asDiagonal()});
    body.parent = is_upper ? 0 : first + i - 1;
    body.X_PB.translation() =
        is_upper
            ? Vector3((is_front(leg) ? 0.2 : -0.2) + (is_left ? -0.5 : 0.5) * apart, 0.15 * side_sign(leg), 0)
            : Vector3(0, 0, -kUpper);
    Joint& joint = body.joint;
    joint.name = body.name + "_joint";
    joint.axis = Vector3::UnitY();
    joint.armature = is_upper ? 1e-3 : 0;
    joint.damping = is_upper ? 0.02 : 1e-3;
    joint.actuated = is_upper;
    if (is_upper) joint.kp = 30, joint.kd = 0.5, joint.effort_limit = 7;
    if (!is_upper && is_left)
      body.shapes.push_back(
          shape(fmt::format("{}_foot", name(leg)), ShapeType::kSphere, {0.01, 0, 0}, {0, 0, -kLower}));
    robot.bodies.push_back(std::move(body));
  }
  model.foot_body = first + 3;
  model.p_BF = {0, 0, -kLower};
  model.foot_radius = 0.01;
  robot.loops.push_back({fmt::format("{}_tip", name(leg)), first + 3, first + 4, model.p_BF, model.p_BF});
}

}  // namespace

RobotPtr planar_five_bars(double apart) {
  RobotDescription robot;
  robot.name = "planar_five_bars";
  robot.bodies.push_back(free_body("trunk", solid_box(3, {0.2, 0.1, 0.05})));
  robot.legs.emplace();
  for (const Leg leg : kLegs) add_planar_five_bar(robot, leg, apart);
  robot.home = JointVector::Zero(robot.joint_count());
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    const auto left = link_angles(apart / 2, -1), right = link_angles(-apart / 2, 1);
    robot.home[model.servos[0]] = left[0];
    robot.home[model.servos[1]] = right[0];
    robot.home[model.passive[0]] = left[1] - left[0];
    robot.home[model.passive[1]] = right[1] - right[0];
  }
  robot.standing_height = kStands;
  robot.home_height = kStands + 0.01;
  return finished(robot);
}

}  // namespace crossgait::scenes
