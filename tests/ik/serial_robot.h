// Robots with one serial leg, built in code: what the kinematics are derived from and compared with.
#pragma once

#include <random>
#include <vector>

#include "ik/serial_leg.h"
#include "physics/robot/multibody.h"

namespace crossgait::test {

inline double uniform(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

inline Vector3 random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vector3(normal(random), normal(random), normal(random)).normalized();
}

/// Describes a leg at zero angles, in the base frame: where its joints are and how they turn.
struct LegAtZero {
  Leg leg = Leg::FL;
  bool has_abduction = true;
  Vector3 abduction = {0.2, 0.05, 0.01}, hip = {0.2, 0.13, 0.01}, knee = {0.2, 0.13, -0.2},
          foot = {0.2, 0.13, -0.41};
  Vector3 abduction_axis = Vector3::UnitX(), hip_axis = Vector3::UnitY(), knee_axis = Vector3::UnitY();

  double thigh() const { return Vector2(knee.x() - hip.x(), knee.z() - hip.z()).norm(); }
  double shin() const { return Vector2(foot.x() - knee.x(), foot.z() - knee.z()).norm(); }
};

/// Draws any signs, offsets and zero angles.
inline LegAtZero random_leg(std::mt19937& random, bool has_abduction) {
  const auto offset = [&](double size) {
    return Vector3(uniform(random, -size, size), uniform(random, -size, size), uniform(random, -size, size));
  };
  const auto link = [&] {
    const double length = uniform(random, 0.05, 0.5), angle = uniform(random, -M_PI, M_PI);
    return Vector3(length * std::cos(angle), uniform(random, -0.05, 0.05), length * std::sin(angle));
  };
  const auto sign = [&] { return random() % 2 == 0 ? 1.0 : -1.0; };
  LegAtZero leg;
  leg.leg = kLegs[random() % 4];
  leg.has_abduction = has_abduction;
  leg.abduction = offset(0.4);
  leg.hip = leg.abduction + offset(0.1);
  leg.knee = leg.hip + link();
  leg.foot = leg.knee + link();
  leg.abduction_axis *= sign();
  leg.hip_axis *= sign();
  leg.knee_axis *= sign();
  return leg;
}

/// Turns the joints' axes by `angle` about random directions across them, and the leg no longer is in planes
/// y = const.
inline void make_oblique(LegAtZero& leg, double angle, std::mt19937& random) {
  for (Vector3* axis : {&leg.abduction_axis, &leg.hip_axis, &leg.knee_axis}) {
    const Vector3 across = axis->cross(random_direction(random)).normalized();
    *axis = Eigen::AngleAxisd(angle, across) * *axis;
  }
}

struct SerialRobot {
  RobotDescription robot;
  SerialLegJoints joints;

  int joint_count() const { return robot.joint_count(); }
  std::vector<int> servos() const {
    if (joints.abduction == -1) return {joints.hip, joints.knee};
    return {joints.abduction, joints.hip, joints.knee};
  }
  /// Places the foot in the base frame by the forward kinematics of physics/, which share nothing with ik/.
  Vector3 foot(const JointVector& q) const {
    RobotState state;
    state.q = q;
    state.qd = JointVector::Zero(q.size());
    std::vector<Pose> poses;
    forward_kinematics(robot, state, poses);
    return poses[static_cast<std::size_t>(joints.foot_body)] * joints.p_BF;
  }
  Vector3 foot(const SerialAngles& angles) const {
    JointVector q = JointVector::Zero(joint_count());
    if (joints.abduction != -1) q[joints.abduction] = angles.abduction;
    q[joints.hip] = angles.hip;
    q[joints.knee] = angles.knee;
    return foot(q);
  }
};

/// @param random  turns every body's frame anyhow; without it frames are the base's
inline SerialRobot serial_robot(const LegAtZero& leg, std::mt19937* random = nullptr) {
  SerialRobot made;
  made.robot.name = made.robot.source = "made.urdf";
  made.robot.bodies.resize(1);
  made.robot.bodies[0].name = "base";
  Pose X_parent = Pose::Identity();
  const auto add = [&](const char* joint, const Vector3& p, const Vector3& axis) {
    Pose X = Pose::Identity();
    X.translation() = p;
    if (random != nullptr) X.rotate(Eigen::AngleAxisd(uniform(*random, -3, 3), random_direction(*random)));
    Body body;
    body.name = joint + std::string("_link");
    body.parent = made.joint_count();
    body.X_PB = X_parent.inverse() * X;
    body.joint.name = joint;
    body.joint.axis = X.linear().transpose() * axis;
    made.robot.bodies.push_back(body);
    X_parent = X;
    return made.joint_count() - 1;
  };
  if (leg.has_abduction) made.joints.abduction = add("abduction", leg.abduction, leg.abduction_axis);
  made.joints.hip = add("hip", leg.hip, leg.hip_axis);
  made.joints.knee = add("knee", leg.knee, leg.knee_axis);
  made.joints.foot_body = made.joints.knee + 1;
  made.joints.p_BF = X_parent.inverse() * leg.foot;
  return made;
}

inline SerialLegGeometry geometry(const LegAtZero& leg, const SerialRobot& made) {
  return serial_leg_geometry(made.robot, leg.leg, made.joints);
}

/// Places a foot in the base frame that the leg reaches: (x, depth) from the hip in the plane of the leg
/// turned by `tilt` about +x, from the leg's own figures.
inline Vector3 foot_in_plane(const LegAtZero& leg, double x, double depth, double tilt) {
  Vector3 at_zero(leg.hip.x() + x, leg.foot.y(), leg.hip.z() - depth);
  if (!leg.has_abduction) return at_zero;
  return leg.abduction + Eigen::AngleAxisd(tilt, Vector3::UnitX()) * (at_zero - leg.abduction);
}

/// Does so at random: anywhere in the ring between straight and folded that is below the abduction axis.
inline Vector3 random_foot(const LegAtZero& leg, std::mt19937& random, double edge = 0) {
  const double near = std::abs(leg.thigh() - leg.shin()), far = leg.thigh() + leg.shin();
  while (true) {
    const double r = uniform(random, near + edge * (far - near), far - edge * (far - near));
    const double angle = uniform(random, -M_PI, M_PI), depth = r * std::cos(angle);
    // Below the abduction axis by 0.1 mm: nearer, the half turn between the two ways there is not told apart.
    if (leg.has_abduction && depth + leg.abduction.z() - leg.hip.z() < 1e-4) continue;
    return foot_in_plane(leg, r * std::sin(angle), depth, uniform(random, -3, 3));
  }
}

inline void set_limits(RobotDescription& robot, int joint, double lower, double upper) {
  Joint& j = robot.bodies[static_cast<std::size_t>(joint) + 1].joint;
  j.lower = lower;
  j.upper = upper;
}

}  // namespace crossgait::test
