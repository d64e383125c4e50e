#include "ik/leg_frames.h"

#include <cmath>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

/// (x, depth) of a vector of the base frame at zero tilt.
Vector2 in_plane(const Vector3& v) { return {v.x(), -v.z()}; }

}  // namespace

void LegFrames::fail(std::string_view what, const std::string& expected, const std::string& found) const {
  throw ConfigError(robot_.source, fmt::format("leg {} {}", name(leg_), what), expected, found);
}

Pose LegFrames::pose(int joint) const {
  Pose X = Pose::Identity();
  for (int body = joint + 1; body > 0; body = at(body).parent) X = at(body).X_PB * X;
  return X;
}

bool LegFrames::is_along(int joint, const Vector3& direction) const {
  const Vector3 a = axis(joint);
  return (a - std::copysign(1.0, a.dot(direction)) * direction).norm() <= aligned_;
}

double LegFrames::axis_sign(int joint, const Vector3& direction, std::string_view along) const {
  const Vector3 a = axis(joint);
  if (!is_along(joint, direction)) {
    fail("axis of joint " + robot_.joint(joint).name,
         fmt::format("parallel to {} of the base at zero angles", along),
         fmt::format("({:g}, {:g}, {:g})", a.x(), a.y(), a.z()));
  }
  return std::copysign(1.0, a.dot(direction));
}

void LegFrames::require_parent(int joint, int parent_body) const {
  if (at(joint + 1).parent != parent_body) {
    fail("joint " + robot_.joint(joint).name, "child of " + at(parent_body).name,
         "child of " + at(at(joint + 1).parent).name);
  }
}

void LegFrames::require_joint(int joint, std::string_view what) const {
  if (joint < 0 || joint >= robot_.joint_count()) {
    fail(what, fmt::format("a joint from 0 to {}", robot_.joint_count() - 1), fmt::format("{}", joint));
  }
}

TwoLinkChain two_link_chain(const LegFrames& frames, int shoulder, int elbow, const Vector3& tip) {
  const Vector3 y = Vector3::UnitY();
  TwoLinkChain c;
  // A rotation about +y carries x towards -z, that is down: it increases plane angles.
  c.shoulder_sign = frames.axis_sign(shoulder, y, "y");
  c.elbow_sign = frames.axis_sign(elbow, y, "y");
  c.shoulder_limits = frames.limits(shoulder);
  c.elbow_limits = frames.limits(elbow);
  const Pose X_elbow = frames.pose(elbow);
  const Vector2 upper = in_plane(X_elbow.translation() - frames.pose(shoulder).translation());
  const Vector2 lower = in_plane(X_elbow.linear() * tip);
  c.upper = upper.norm();
  c.lower = lower.norm();
  if (c.upper > 0) c.upper_zero = upper / c.upper;
  if (c.upper > 0 && c.lower > 0) c.lower_zero = Vector2(upper.dot(lower), cross(upper, lower)).normalized();
  return c;
}

}  // namespace crossgait
