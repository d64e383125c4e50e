#include "ik/serial_leg.h"

#include <cmath>

#include <fmt/format.h>

#include "ik/leg_frames.h"

namespace crossgait {
namespace {

constexpr double kAtHip = 1e-12;  // m, what rounding makes of a target on the hip axis

/// A standing posture's depth, for requests that make no sense.
double neutral_depth(const TwoLinkChain& chain) {
  constexpr double kFraction = 0.7;
  return std::max(kFraction * largest_reach(chain), smallest_reach(chain));
}

/// Links of a posture, and its foot in the leg's plane.
struct SerialPosture {
  ChainLinks links;
  Vector2 foot;
  double c = 1, s = 0;  // of the outward tilt
};

SerialPosture posture(const SerialLegGeometry& g, const SerialAngles& q) {
  SerialPosture p;
  p.links.upper = upper_link(g.chain, q.hip);
  p.links.lower = lower_link(g.chain, p.links.upper, q.knee);
  p.foot = p.links.upper + p.links.lower;
  if (g.has_abduction) {
    p.c = std::cos(q.abduction);
    p.s = g.tilt_sign * std::sin(q.abduction);
  }
  return p;
}

}  // namespace

SerialLegJoints serial_leg_joints(const LegModel& model) {
  return {model.joint("abduction"),
          model.joint("hip"),
          model.joint("knee"),
          model.foot_body,
          model.p_BF,
          model.linkage == LegLinkage::kHipFirst,
          model.joint("ankle"),
          model.linkage == LegLinkage::kKneeFollows};
}

SerialChain chain_of(const SerialLegJoints& joints) {
  const int ankles = joints.ankle == -1 ? 0 : 1;
  if (joints.abduction == -1) return {{joints.hip, joints.knee, joints.ankle}, 2 + ankles, 0, 2};
  if (joints.hip_first) return {{joints.hip, joints.abduction, joints.knee, joints.ankle}, 3 + ankles, 0, 3};
  return {
      {joints.abduction, joints.hip, joints.knee, joints.ankle}, 3 + ankles, 1, joints.knee_follows ? 2 : 3};
}

void validate(const RobotDescription& robot, Leg leg, const SerialLegJoints& joints) {
  const LegFrames frames(robot, leg, 0);
  if (joints.abduction != -1) frames.require_joint(joints.abduction, "abduction");
  frames.require_joint(joints.hip, "hip");
  frames.require_joint(joints.knee, "knee");
  const SerialChain chain = chain_of(joints);
  int parent = 0;
  for (int i = 0; i < chain.count; ++i) {
    const int joint = chain.joints[static_cast<std::size_t>(i)];
    frames.require_parent(joint, parent);
    parent = joint + 1;
  }
  if (joints.foot_body != parent) {
    frames.fail("foot",
                fmt::format("on the body that the {} moves, {}", joints.ankle == -1 ? "knee" : "ankle",
                            frames.at(parent).name),
                fmt::format("on body {}", joints.foot_body));
  }
}

bool is_serial_leg(const RobotDescription& robot, Leg leg, const SerialLegJoints& joints, double tolerance) {
  validate(robot, leg, joints);
  const LegFrames frames(robot, leg, tolerance);
  return !joints.hip_first && joints.ankle == -1 && !joints.knee_follows &&
         (joints.abduction == -1 || frames.is_along(joints.abduction, Vector3::UnitX())) &&
         frames.is_along(joints.hip, Vector3::UnitY()) && frames.is_along(joints.knee, Vector3::UnitY());
}

SerialLegGeometry serial_leg_geometry(const RobotDescription& robot, Leg leg, const SerialLegJoints& joints,
                                      double tolerance) {
  validate(robot, leg, joints);
  const LegFrames frames(robot, leg, tolerance);
  if (joints.hip_first) frames.fail("joints", "an abduction before the hip", "one behind it");
  if (joints.ankle != -1 || joints.knee_follows)
    frames.fail("joints", "a servo on each", "one that follows another");
  SerialLegGeometry g;
  g.side = side_sign(leg);
  g.has_abduction = joints.abduction != -1;
  g.chain = two_link_chain(frames, joints.hip, joints.knee, joints.p_BF);
  if (!(g.chain.upper > 0)) frames.fail("thigh", "a positive length", fmt::format("{:g} m", g.chain.upper));
  if (!(g.chain.lower > 0)) frames.fail("shin", "a positive length", fmt::format("{:g} m", g.chain.lower));

  const Vector3 hip = frames.pose(joints.hip).translation();
  g.p_BL = {hip.x(), (frames.pose(joints.knee) * joints.p_BF).y(), hip.z()};
  if (g.has_abduction) {
    // A rotation about +x carries a hanging leg towards +y.
    g.tilt_sign = g.side * frames.axis_sign(joints.abduction, Vector3::UnitX(), "x");
    g.tilt_limits = frames.limits(joints.abduction);
    const Vector3 axis = frames.pose(joints.abduction).translation();
    g.axis_to_plane_out = g.side * (g.p_BL.y() - axis.y());
    g.axis_to_shoulder_down = axis.z() - hip.z();
  }
  return g;
}

SerialSolution solve_serial(const SerialLegGeometry& g, const Vector3& target, KneeBranch branch) noexcept {
  SerialSolution solution;
  const bool finite = target.allFinite();
  Vector3 p = finite ? target : Vector3(0, 0, -neutral_depth(g.chain));
  p = p.cwiseMax(-kFar).cwiseMin(kFar);
  Vector2 foot(p.x(), -p.z());
  IkStatus aside = IkStatus::kOk;
  if (g.has_abduction) {
    const auto [tilt, c, s, D, too_near] = plane_through(g, p.y(), p.z(), 0);
    solution.angles.abduction = tilt;
    foot.y() = D - g.axis_to_shoulder_down;
    if (too_near) aside = IkStatus::kClampedTooNear;
  } else if (std::abs(p.y()) > kOffPlane) {
    aside = IkStatus::kClampedTooFar;
  }
  if (foot.squaredNorm() < kAtHip * kAtHip) foot.setZero();
  solution.status = clamp_to_reach(g.chain, foot);
  if (solution.status == IkStatus::kOk) solution.status = aside;
  const ChainLinks links = place_links(g.chain, foot, knee_sign(branch));
  solution.angles.hip = shoulder_angle(g.chain, links);
  solution.angles.knee = elbow_angle(g.chain, links);

  bool limited = g.has_abduction && fit_angle(solution.angles.abduction, g.tilt_limits);
  limited |= fit_angle(solution.angles.hip, g.chain.shoulder_limits);
  limited |= fit_angle(solution.angles.knee, g.chain.elbow_limits);
  if (limited && solution.status == IkStatus::kOk) solution.status = IkStatus::kClampedJointLimit;
  if (!finite) solution.status = IkStatus::kInvalidTarget;
  return solution;
}

Vector3 forward_serial(const SerialLegGeometry& g, const SerialAngles& q) noexcept {
  const SerialPosture p = posture(g, q);
  return tilted(g, p.foot, p.c, p.s);
}

Matrix3 serial_jacobian(const SerialLegGeometry& g, const SerialAngles& q) noexcept {
  const SerialPosture p = posture(g, q);
  const Vector2 &foot = p.foot, &lower = p.links.lower;
  Matrix3 J;
  J.col(0) = g.has_abduction ? tilt_column(g, foot.y(), p.c, p.s) : Vector3(Vector3::Zero());
  J.col(1) = g.chain.shoulder_sign * tilted_velocity(g, {-foot.y(), foot.x()}, p.c, p.s);
  J.col(2) = g.chain.elbow_sign * tilted_velocity(g, {-lower.y(), lower.x()}, p.c, p.s);
  return J;
}

LegMargins serial_margins(const SerialLegGeometry& g, const SerialAngles& q) noexcept {
  const SerialPosture p = posture(g, q);
  LegMargins margins{
      std::min(limit_margin(q.hip, g.chain.shoulder_limits), limit_margin(q.knee, g.chain.elbow_limits)),
      elbow_margin(p.links), M_PI_2};
  if (g.has_abduction) {
    margins.joint_limit = std::min(margins.joint_limit, limit_margin(q.abduction, g.tilt_limits));
    const double D = p.foot.y() + g.axis_to_shoulder_down;
    margins.serial = std::min(margins.serial, std::atan2(std::abs(D), largest_reach(g.chain)));
  }
  return margins;
}

double knee_bend(const SerialLegGeometry& g, double knee) noexcept {
  const Vector2 upper(g.chain.upper, 0);
  return angle_between(upper, lower_link(g.chain, upper, knee));
}

}  // namespace crossgait
