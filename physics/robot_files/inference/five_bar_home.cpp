#include <array>
#include <cmath>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/math.h"
#include "physics/robot/multibody.h"
#include "physics/robot_files/inference/robot_inference.h"
#include "physics/robot_files/inference/turn_within.h"

namespace crossgait {
namespace {

using Vector2 = Eigen::Vector2d;

/// A chain of shoulder and elbow at zero angles, in the plane across y: points are (x, z).
struct PlanarChain {
  int shoulder = -1, elbow = -1;                             // joints
  Vector2 origin = Vector2::Zero();                          // of the shoulder
  Vector2 upper = Vector2::Zero(), lower = Vector2::Zero();  // links to the elbow and to the tip
  double shoulder_sign = 1, elbow_sign = 1;

  double length() const { return upper.norm() + lower.norm(); }
};

Vector2 in_side_plane(const Vector3& p) { return {p.x(), p.z()}; }

/// From u to v about +y, rad: which turns z towards x.
double turn_about_y(const Vector2& u, const Vector2& v) {
  return std::atan2(u.y() * v.x() - u.x() * v.y(), u.dot(v));
}

Vector3 tip_on(const RobotDescription& robot, int body) {
  for (const LoopClosure& loop : robot.loops) {
    if (loop.body_a == body) return loop.p_AP;
    if (loop.body_b == body) return loop.p_BP;
  }
  throw ConfigError(robot.source, "loops", "one that joins the two lower links of each five-bar", "none");
}

std::array<PlanarChain, 2> chains_of(const RobotDescription& robot, Leg leg) {
  const LegModel& model = (*robot.legs)[leg];
  RobotState zero;
  zero.q = JointVector::Zero(robot.joint_count());
  std::vector<Pose> poses;
  forward_kinematics(robot, zero, poses);
  const auto chain = [&](const char* shoulder, const char* elbow) {
    PlanarChain c{.shoulder = model.joint(shoulder), .elbow = model.joint(elbow)};
    const Pose& X_shoulder = poses[static_cast<std::size_t>(c.shoulder) + 1];
    const Pose& X_elbow = poses[static_cast<std::size_t>(c.elbow) + 1];
    c.origin = in_side_plane(X_shoulder.translation());
    c.upper = in_side_plane(X_elbow.translation()) - c.origin;
    c.lower = in_side_plane(X_elbow * tip_on(robot, c.elbow + 1)) - in_side_plane(X_elbow.translation());
    c.shoulder_sign = (X_shoulder.linear() * robot.joint(c.shoulder).axis).y() < 0 ? -1 : 1;
    c.elbow_sign = (X_elbow.linear() * robot.joint(c.elbow).axis).y() < 0 ? -1 : 1;
    return c;
  };
  return {chain("shoulder_left", "elbow_left"), chain("shoulder_right", "elbow_right")};
}

/// Puts the chain's tip on `foot`. @param side  of the elbow: -1 behind, +1 ahead
void place_chain(const RobotDescription& robot, Leg leg, const PlanarChain& c, const Vector2& foot,
                 double side, JointVector& q) {
  const Vector2 d = foot - c.origin;
  const double u = c.upper.norm(), l = c.lower.norm(), r = d.norm();
  const auto refuse = [&](const std::string& expected, const std::string& found) {
    throw ConfigError(robot.source, fmt::format("home of leg {}", name(leg)), expected, found);
  };
  const double along = (r * r + u * u - l * l) / (2 * r), across2 = u * u - along * along;
  if (!(across2 >= 0))
    refuse(fmt::format("links that reach {:.3g} m below the shoulders", -foot.y() + c.origin.y()),
           fmt::format("{:.3g} m and {:.3g} m", u, l));
  const Vector2 to_foot = d / r, ahead = Vector2(-to_foot.y(), to_foot.x());  // of a line down, towards +x
  const Vector2 upper = along * to_foot + side * std::sqrt(across2) * ahead;
  const double turned = turn_about_y(c.upper, upper);
  const double bend = turn_about_y(c.lower, d - upper) - turned;
  for (const auto& [joint, angle] :
       {std::pair(c.shoulder, c.shoulder_sign * turned), {c.elbow, c.elbow_sign * wrapped(bend)}}) {
    const auto fitting = turn_within(angle, robot.joint(joint));
    if (!fitting)
      refuse(fmt::format("joint '{}' within its limits, {:.3g} to {:.3g} rad, or a `home` in a robot.yaml",
                         robot.joint(joint).name, robot.joint(joint).lower, robot.joint(joint).upper),
             fmt::format("{:.3g} rad with elbows outward", angle));
    q[joint] = *fitting;
  }
}

}  // namespace

double five_bar_length(const RobotDescription& robot, Leg leg) {
  const auto [left, right] = chains_of(robot, leg);
  return (left.length() + right.length()) / 2;
}

JointVector find_five_bar_home(const RobotDescription& robot, double height,
                               std::vector<Inference>& inferred) {
  JointVector q = JointVector::Zero(robot.joint_count());
  for (const Leg leg : kLegs) {
    const auto [left, right] = chains_of(robot, leg);
    const Vector2 foot = (left.origin + right.origin) / 2 - Vector2(0, height);
    place_chain(robot, leg, left, foot, -1, q);
    place_chain(robot, leg, right, foot, 1, q);
  }
  inferred.push_back({"home", fmt::format("feet {:.4g} m below the shoulders, elbows outward", height),
                      "no pose of the file is called home"});
  return q;
}

}  // namespace crossgait
