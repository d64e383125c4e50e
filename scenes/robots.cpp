#include "scenes/robots.h"

#include <array>
#include <cmath>
#include <utility>

#include "physics/robot/multibody.h"
#include "physics/robot_files/data_path.h"
#include "scenes/robot_pieces.h"

namespace crossgait::scenes {
namespace {

// An inertia with the given principal moments about axes turned by `rotation` against the body's.
SpatialInertia turned_inertia(double mass, const Vector3& p_BC, const Vector3& moments,
                              const Quaternion& rotation) {
  const Matrix3 R = rotation.toRotationMatrix();
  const Matrix3 I = R * moments.asDiagonal() * R.transpose();
  return {mass, p_BC, 0.5 * (I + I.transpose())};
}

RobotPtr load(const char* name) { return std::make_shared<RobotDescription>(load_robot(find_robot(name))); }

}  // namespace

RobotPtr quadruped() {
  static const RobotPtr kRobot = load("scara_quadruped");
  return kRobot;
}

RobotPtr long_quadruped() {
  static const RobotPtr kRobot = load("scara_quadruped_long");
  return kRobot;
}

RobotPtr serial_quadruped() {
  static const RobotPtr kRobot = load("serial_quadruped");
  return kRobot;
}

SpatialInertia solid_box(double mass, const Vector3& half_extents, const Vector3& p_BC) {
  const Vector3 s = half_extents.cwiseAbs2();
  const Vector3 moments = mass / 3 * Vector3(s.y() + s.z(), s.x() + s.z(), s.x() + s.y());
  return {mass, p_BC, moments.asDiagonal()};
}

RobotPtr tumbling_body() {
  RobotDescription robot;
  robot.name = "tumbling_body";
  robot.bodies.push_back(free_body("body", turned_inertia(0.7, {0.03, -0.02, 0.05}, {1.1e-3, 2.3e-3, 3.0e-3},
                                                          from_roll_pitch_yaw(0.4, -0.7, 1.1))));
  return finished(robot);
}

namespace {

Body arm_body(const std::string& number, const ArmLink& link) {
  // A slender body: its inertia about its long axis is small, and does not matter.
  const Vector3 moments(link.inertia, link.inertia, 0.1 * link.inertia);
  Body body = free_body("link" + number, {link.mass, {0, 0, -link.length}, moments.asDiagonal()});
  Joint& joint = body.joint;
  joint.name = "joint" + number;
  joint.axis = Vector3::UnitY();
  joint.damping = link.damping;
  joint.friction = link.friction;
  joint.armature = link.armature;
  joint.actuated = link.servo;
  joint.kp = link.kp;
  joint.kd = link.kd;
  joint.effort_limit = link.effort_limit;
  joint.lower = -link.limit;
  joint.upper = link.limit;
  joint.limited = link.limited;
  return body;
}

}  // namespace

RobotPtr arm(const std::vector<ArmLink>& links) {
  RobotDescription robot;
  robot.name = "arm";
  robot.bodies.push_back(free_body("base", solid_box(1, {0.05, 0.05, 0.05})));
  double joint_depth = 0;
  for (std::size_t i = 0; i < links.size(); ++i) {
    Body body = arm_body(std::to_string(i), links[i]);
    body.parent = static_cast<int>(i);
    body.X_PB.translation().z() = -joint_depth;
    joint_depth = 2 * links[i].length;
    robot.bodies.push_back(body);
  }
  return finished(robot);
}

RobotPtr geared_pendulums(const ArmLink& leader, const ArmLink& follower, double ratio) {
  RobotDescription robot;
  robot.name = "geared_pendulums";
  robot.bodies.push_back(free_body("base", solid_box(1, {0.05, 0.05, 0.05})));
  for (const auto& [link, y] : {std::pair(leader, 0.1), std::pair(follower, -0.1)}) {
    Body body = arm_body(std::to_string(robot.joint_count()), link);
    body.parent = 0;
    body.X_PB.translation().y() = y;
    robot.bodies.push_back(body);
  }
  robot.couplings.push_back({.follower = 1, .leader = 0, .coefficients = {0, ratio}});
  return finished(robot);
}

RobotPtr sled() {
  RobotDescription robot;
  robot.name = "sled";
  Body body = free_body("sled", solid_box(1, {0.1, 0.1, 0.01}));
  for (int corner = 0; corner < 4; ++corner) {
    const Vector3 centre((corner & 1) != 0 ? 0.1 : -0.1, (corner & 2) != 0 ? 0.1 : -0.1, 0);
    body.shapes.push_back(
        shape("runner" + std::to_string(corner), ShapeType::kSphere, {kSledRadius, 0, 0}, centre));
  }
  robot.bodies.push_back(body);
  robot.home_height = kSledRadius;
  return finished(robot);
}

RobotPtr block(ShapeType type, const Vector3& size) { return block(shape("shape", type, size)); }

RobotPtr block(CollisionShape shape) {
  RobotDescription robot;
  robot.name = "block";
  Body body = free_body("block", solid_box(0.5, {0.05, 0.05, 0.05}));
  body.shapes.push_back(std::move(shape));
  robot.bodies.push_back(body);
  return finished(robot);
}

CollisionShape gem() {
  CollisionShape hull = shape("gem", ShapeType::kHull, Vector3::Zero());
  for (int i = 0; i < 12; ++i) {
    const double z = 1 - (2 * i + 1) / 12.0, angle = 2.4 * i;  // a spiral around a ball
    const double across = std::sqrt(1 - z * z);
    hull.vertices.push_back(
        Vector3(0.06, 0.045, 0.035)
            .cwiseProduct(Vector3(across * std::cos(angle), across * std::sin(angle), z)));
  }
  return hull;
}

RobotPtr assortment() {
  RobotDescription robot;
  robot.name = "assortment";
  Body trunk = free_body("trunk", solid_box(2, {0.15, 0.08, 0.04}, {0.02, -0.01, 0.005}));
  trunk.shapes.push_back(shape("trunk", ShapeType::kBox, {0.15, 0.08, 0.04}));
  robot.bodies.push_back(trunk);
  const std::array<CollisionShape, 4> limbs{shape("cylinder", ShapeType::kCylinder, {0.03, 0.06, 0}),
                                            shape("capsule", ShapeType::kCapsule, {0.025, 0.07, 0}), gem(),
                                            shape("box", ShapeType::kBox, {0.03, 0.04, 0.06})};
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    const double front = i < 2 ? 1 : -1, left = i % 2 == 0 ? 1 : -1;
    const Vector3 centre(0.02, 0.06 * left, -0.08);
    Body limb = free_body("limb_" + limbs[i].name, solid_box(0.3, {0.03, 0.03, 0.06}, centre));
    limb.parent = 0;
    limb.X_PB.translation() = Vector3(0.14 * front, 0.08 * left, 0);
    limb.joint.name = "swing_" + limbs[i].name;
    limb.joint.axis = Vector3(0.3, 1, 0.2 * left).normalized();
    limb.joint.actuated = true;
    limb.joint.armature = 1e-3;
    limb.joint.kp = 8;
    limb.joint.kd = 0.1;
    limb.joint.effort_limit = 4;
    limb.shapes.push_back(limbs[i]);
    limb.shapes.back().X_BG.translation() = centre;
    limb.shapes.back().X_BG.linear() = from_roll_pitch_yaw(0.4, 0.2 * left, 0.1).toRotationMatrix();
    robot.bodies.push_back(limb);
  }
  robot.home_height = 0.2;
  return finished(robot);
}

RobotPtr millipede(int legs, int toes) {
  constexpr double kLink = 0.04, kRadius = 0.008;  // m; forward or backward as much as down
  RobotDescription robot;
  robot.name = "millipede";
  robot.bodies.push_back(free_body("trunk", solid_box(0.34, {0.2, 0.05, 0.02})));
  for (int i = 0; i < legs; ++i) {
    const int row = i / 2, last = legs / 2 - 1;
    const double side = i % 2 == 0 ? 1 : -1, ahead = row % 2 == 0 ? 1 : -1;
    const Vector3 tip(ahead * kLink, 0, -kLink);
    Body leg = free_body("leg" + std::to_string(i), solid_box(0.02, {0.005, 0.005, 0.03}, tip / 2));
    leg.parent = 0;
    leg.X_PB.translation() = Vector3(0.025 * (row - last / 2.0), side * 0.06, 0);
    leg.joint.name = "hip" + std::to_string(i);
    leg.joint.axis = Vector3::UnitY();
    leg.joint.damping = 0.02;
    leg.joint.armature = 2e-4;
    leg.joint.actuated = true;
    leg.joint.kp = leg.joint.effort_limit = 1;
    for (int toe = 0; toe < toes; ++toe) {
      const Vector3 centre = tip + Vector3(0, 0.01 * toe, 0);
      leg.shapes.push_back(
          shape("foot" + std::to_string(i * toes + toe), ShapeType::kSphere, {kRadius, 0, 0}, centre));
    }
    robot.bodies.push_back(leg);
  }
  robot.home_height = kLink + kRadius;
  return finished(robot);
}

RobotPtr heavy_sledge(int points) {
  constexpr double kRadius = 0.02, kBelly = 0.1;  // m
  RobotDescription robot;
  robot.name = "heavy_sledge";
  robot.bodies.push_back(free_body("trunk", solid_box(30, {0.4, 0.15, kBelly}, {0.02, -0.01, 0.01})));
  for (int i = 0; i < points; ++i) {
    const int row = i / 2, last = std::max(1, points / 2 - 1);
    const double ahead = 0.8 * row / last - 0.4, left = i % 2 == 0 ? 0.15 : -0.15;
    robot.bodies[0].shapes.push_back(shape("belly" + std::to_string(i), ShapeType::kSphere, {kRadius, 0, 0},
                                           {ahead, left, kRadius - kBelly}));
  }
  for (int i = 0; i < 4; ++i) {
    const Vector3 tip(0.25, 0, 0.05);
    Body leg = free_body("leg" + std::to_string(i), solid_box(1.5, {0.12, 0.02, 0.02}, tip / 2));
    leg.parent = 0;
    leg.X_PB.translation() = Vector3(i < 2 ? 0.35 : -0.35, i % 2 == 0 ? 0.2 : -0.2, 0);
    leg.joint.name = "hip" + std::to_string(i);
    leg.joint.axis = Vector3::UnitY();
    leg.joint.damping = 0.5;
    leg.joint.armature = 0.02;
    leg.joint.actuated = true;
    leg.joint.kp = 60;
    leg.joint.effort_limit = 40;
    leg.shapes.push_back(shape("foot" + std::to_string(i), ShapeType::kSphere, {kRadius, 0, 0}, tip));
    robot.bodies.push_back(leg);
  }
  robot.home_height = kBelly;
  return finished(robot);
}

namespace {

struct AwkwardLink {
  int parent;
  Vector3 p_PB, roll_pitch_yaw, axis, p_BC, moments;
  double mass, armature, damping;
  bool servo;
};

// Two branches: base - 1 - 2 - 3 and base - 4 - 5.
std::vector<AwkwardLink> awkward_links() {
  return {
      {0,
       {0.1, 0.05, 0.02},
       {0.2, -0.4, 0.6},
       {1, 2, -1},
       {0.01, 0.02, -0.05},
       {1e-4, 2e-4, 2.5e-4},
       0.12,
       2e-4,
       0.02,
       true},
      {1,
       {0.02, 0.01, -0.1},
       {-0.9, 0.1, 0.3},
       {0, 1, 0},
       {0, -0.01, -0.04},
       {4e-5, 6e-5, 9e-5},
       0.05,
       1e-4,
       0,
       true},
      {2,
       {0, 0.02, -0.08},
       {0.1, 1.2, -0.5},
       {1, 1, 1},
       {0.02, 0, -0.03},
       {1e-5, 2e-5, 2.2e-5},
       0.03,
       0,
       0.01,
       false},
      {0,
       {-0.1, 0.04, 0},
       {0.7, 0.2, 2.1},
       {0, -1, 3},
       {-0.01, 0.03, -0.04},
       {2e-4, 1e-4, 2e-4},
       0.1,
       3e-4,
       0.03,
       true},
      {4,
       {0.03, -0.02, -0.09},
       {0.4, -0.8, -1.4},
       {2, 0, 1},
       {0, 0.01, -0.05},
       {3e-5, 5e-5, 6e-5},
       0.04,
       0,
       0,
       false},
  };
}

}  // namespace

RobotPtr awkward_robot() {
  RobotDescription robot;
  robot.name = "awkward";
  robot.bodies.push_back(free_body("base", turned_inertia(0.9, {0.02, -0.03, 0.04}, {2e-3, 3e-3, 4e-3},
                                                          from_roll_pitch_yaw(0.3, 0.5, -0.2))));
  const std::vector<AwkwardLink> links = awkward_links();
  for (std::size_t i = 0; i < links.size(); ++i) {
    const AwkwardLink& link = links[i];
    const Vector3& a = link.roll_pitch_yaw;
    Body body = free_body(
        "link" + std::to_string(i),
        turned_inertia(link.mass, link.p_BC, link.moments, from_roll_pitch_yaw(a.z(), a.x(), a.y())));
    body.parent = link.parent;
    body.X_PB = make_pose(from_roll_pitch_yaw(a.x(), a.y(), a.z()), link.p_PB);
    body.joint.name = "joint" + std::to_string(i);
    body.joint.axis = link.axis.normalized();
    body.joint.armature = link.armature;
    body.joint.damping = link.damping;
    body.joint.actuated = link.servo;
    body.joint.kp = 1;
    body.joint.effort_limit = 1;
    body.shapes.push_back(shape("ball" + std::to_string(i), ShapeType::kSphere, {0.01, 0, 0}, 2 * link.p_BC));
    robot.bodies.push_back(body);
  }
  robot.home = JointVector(5);
  robot.home << 0.3, -0.5, 0.8, -0.2, 0.6;
  // The two ends are held together where the home pose has them.
  RobotState home;
  home.q = robot.home;
  std::vector<Pose> poses;
  forward_kinematics(robot, home, poses);
  LoopClosure loop;
  loop.name = "ends";
  loop.body_a = 3;
  loop.body_b = 5;
  loop.p_AP = {0.01, 0.02, -0.06};
  loop.p_BP = poses[5].inverse() * (poses[3] * loop.p_AP);
  robot.loops.push_back(loop);
  robot.home_height = 0.3;
  return finished(robot);
}

RobotPtr finished(RobotDescription robot) {
  if (robot.home.size() == 0) robot.home = JointVector::Zero(robot.joint_count());
  if (robot.source.empty()) robot.source = robot.name + " (built in code)";
  robot.validate();
  return std::make_shared<RobotDescription>(std::move(robot));
}

RobotPtr without_loops(const RobotPtr& robot) {
  RobotDescription open = *robot;
  open.loops.clear();
  open.legs.reset();
  return finished(open);
}

RobotPtr with_joint_friction(const RobotPtr& robot, double friction) {
  RobotDescription changed = *robot;
  for (std::size_t i = 1; i < changed.bodies.size(); ++i) changed.bodies[i].joint.friction = friction;
  return std::make_shared<const RobotDescription>(std::move(changed));
}

RobotPtr with_implicit_servos(const RobotPtr& robot, double stiffer) {
  RobotDescription changed = *robot;
  for (const int i : robot->actuated_joints()) {
    Joint& joint = changed.bodies[static_cast<std::size_t>(i) + 1].joint;
    joint.kp *= stiffer;
    joint.kd *= stiffer;
    joint.implicit_stiffness = joint.implicit_damping = 1;
  }
  return std::make_shared<const RobotDescription>(std::move(changed));
}

RobotPtr with_coupled_hips(const RobotPtr& robot) {
  RobotDescription changed = *robot;
  for (const auto& [hind, front] : {std::pair(Leg::RR, Leg::FL), std::pair(Leg::RL, Leg::FR)}) {
    const auto hip = [&](Leg leg) { return (*changed.legs)[leg].servos[1]; };
    const int follower = hip(hind), leader = hip(front);
    const double sign = changed.joint(follower).axis.dot(changed.joint(leader).axis) < 0
                            ? -1
                            : 1;  // in one pose: hips at zero
    changed.couplings.push_back(
        {.follower = follower,
         .leader = leader,
         .coefficients = {changed.home[follower] - sign * changed.home[leader], sign}});
  }
  return finished(changed);
}

RobotPtr with_joint_limits(const RobotPtr& robot, double range) {
  RobotDescription changed = *robot;
  for (int i = 0; i < changed.joint_count(); ++i) {
    Joint& joint = changed.bodies[static_cast<std::size_t>(i) + 1].joint;
    joint.lower = changed.home[i] - range;
    joint.upper = changed.home[i] + range;
    joint.limited = true;
  }
  return std::make_shared<const RobotDescription>(std::move(changed));
}

}  // namespace crossgait::scenes
