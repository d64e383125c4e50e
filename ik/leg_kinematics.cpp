#include "crossgait/ik/leg_kinematics.h"

#include <algorithm>
#include <cmath>

namespace crossgait {
namespace {

/// Coordinates are clamped to this before they are squared, m: no leg reaches so far, and no square
/// overflows.
constexpr double kFar = 1e3;

Vector2 rotate(const Vector2& v, double c, double s) {
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

double angle_between(const Vector2& from, const Vector2& to) {
  return std::atan2(cross(from, to), from.dot(to));
}

double shoulder_angle(const FiveBarChain& c, const ChainLinks& links) {
  return c.shoulder_sign * angle_between(c.upper_zero, links.upper);
}

double elbow_angle(const FiveBarChain& c, const ChainLinks& links) {
  return c.elbow_sign * angle_between(rotate(links.upper, c.lower_zero.x(), c.lower_zero.y()), links.lower);
}

Vector2 upper_link(const FiveBarChain& c, double shoulder) {
  return c.upper * rotate(c.upper_zero, std::cos(shoulder), c.shoulder_sign * std::sin(shoulder));
}

Vector2 lower_link(const FiveBarChain& c, const Vector2& upper, double elbow) {
  const Vector2 zero = rotate(upper, c.lower_zero.x(), c.lower_zero.y()) / c.upper;
  return c.lower * rotate(zero, std::cos(elbow), c.elbow_sign * std::sin(elbow));
}

bool clamp_angle(double& angle, const JointLimits& limits) {
  const double wanted = angle;
  angle = std::min(std::max(angle, limits.lower), limits.upper);
  return angle != wanted;
}

/// @returns whether anything changed.
bool clamp_to_limits(const FiveBarGeometry& g, ServoAngles& q) {
  bool changed = clamp_angle(q.tilt, g.tilt_limits);
  changed |= clamp_angle(q.shoulder_left, g.a.shoulder_limits);
  changed |= clamp_angle(q.shoulder_right, g.b.shoulder_limits);
  return changed;
}

/// A leg with its foot on the target or as near as the links allow: joint limits do not enter.
struct PlacedLeg {
  IkStatus status = IkStatus::kOk;
  double tilt = 0;  ///< of the joint, rad
  ChainLinks a, b;
};

PlacedLeg place_leg(const FiveBarGeometry& g, const Vector3& target, WorkingMode mode) {
  PlacedLeg leg;
  Vector3 p = target;
  if (!target.allFinite()) {
    leg.status = IkStatus::kInvalidTarget;
    p = {0, 0, -(g.a.upper + g.a.lower + g.b.upper + g.b.lower) / 3};
  }
  p = p.cwiseMax(-kFar).cwiseMin(kFar);
  const double a = g.axis_to_plane_out, b = g.axis_to_shoulder_down;
  const double Y = g.side * p.y() + a, Z = b - p.z();
  const double D2 = Y * Y + Z * Z - a * a, D_min = std::max(b, 0.0);
  const bool too_near = D2 < D_min * D_min;
  const double D = too_near ? D_min : std::sqrt(D2);
  // The difference of the two angles of the tilt equation, as one.
  leg.tilt = g.tilt_sign * std::atan2(Y * D - Z * a, Z * D + Y * a);

  Vector2 foot(p.x(), D - b);
  IkStatus clamped = clamp_to_workspace(g, foot);
  if (too_near && clamped == IkStatus::kOk) clamped = IkStatus::kClampedTooNear;
  if (leg.status == IkStatus::kOk) leg.status = clamped;
  const ElbowSigns signs = elbow_signs(mode);
  leg.a = place_links(g.a, foot, signs.a);
  leg.b = place_links(g.b, foot, signs.b);
  return leg;
}

/// @param limited  set if a joint limit binds
ServoSolution servo_solution(const FiveBarGeometry& g, const PlacedLeg& leg, bool& limited) {
  ServoSolution solution{leg.status, {leg.tilt, shoulder_angle(g.a, leg.a), shoulder_angle(g.b, leg.b)}};
  limited = clamp_to_limits(g, solution.angles);
  if (limited && leg.status == IkStatus::kOk) solution.status = IkStatus::kClampedJointLimit;
  return solution;
}

/// Foot in the leg frame from its place in the leg's plane and the outward tilt (cos, sin).
Vector3 tilted(const FiveBarGeometry& g, const Vector2& p, double c, double s) {
  const double a = g.axis_to_plane_out, b = g.axis_to_shoulder_down, D = p.y() + b;
  return {p.x(), g.side * (a * c + D * s - a), b - (D * c - a * s)};
}

double elbow_margin(const ChainLinks& links) {
  return std::atan2(std::abs(cross(links.upper, links.lower)), std::abs(links.upper.dot(links.lower)));
}

double limit_margin(double angle, const JointLimits& limits) {
  return std::min(angle - limits.lower, limits.upper - angle);
}

}  // namespace

ServoSolution solve_servos(const FiveBarGeometry& g, const Vector3& target, WorkingMode mode) noexcept {
  bool limited = false;
  return servo_solution(g, place_leg(g, target, mode), limited);
}

LegSolution solve_leg(const FiveBarGeometry& g, const Vector3& target, WorkingMode mode) noexcept {
  const PlacedLeg leg = place_leg(g, target, mode);
  bool limited = false;
  const auto [status, servos] = servo_solution(g, leg, limited);
  LegSolution solution{status,
                       {servos.tilt, servos.shoulder_left, servos.shoulder_right, elbow_angle(g.a, leg.a),
                        elbow_angle(g.b, leg.b)}};
  if (limited) {
    // The elbows follow the clamped servos, if the linkage can.
    const LegPosition p = forward_leg(g, servos.tilt, servos.shoulder_left, servos.shoulder_right, mode);
    if (p.closed) {
      solution.angles.elbow_left = p.elbow_left;
      solution.angles.elbow_right = p.elbow_right;
    }
  }
  return solution;
}

LegPosition forward_leg(const FiveBarGeometry& g, double tilt, double shoulder_left, double shoulder_right,
                        WorkingMode mode) noexcept {
  const FiveBarClosure closure =
      close_five_bar(g, upper_link(g.a, shoulder_left), upper_link(g.b, shoulder_right), mode);
  return {closure.closed, tilted(g, closure.foot, std::cos(tilt), g.tilt_sign * std::sin(tilt)),
          elbow_angle(g.a, closure.a), elbow_angle(g.b, closure.b)};
}

Matrix3 leg_jacobian(const FiveBarGeometry& g, const LegAngles& q) noexcept {
  const Vector2 upper_a = upper_link(g.a, q.shoulder_left), upper_b = upper_link(g.b, q.shoulder_right);
  const Vector2 lower_a = lower_link(g.a, upper_a, q.elbow_left),
                lower_b = lower_link(g.b, upper_b, q.elbow_right);
  const Vector2 foot = Vector2(g.a.shoulder_x, 0) + upper_a + lower_a;
  // lower_i . foot' = lower_i . elbow_i', with elbow_i' = (upper_i turned by a right angle) times the plane
  // angle's rate.
  const double along_a = g.a.shoulder_sign * cross(upper_a, lower_a);
  const double along_b = g.b.shoulder_sign * cross(upper_b, lower_b);
  const double det = cross(lower_a, lower_b);
  const Vector2 column_a = Vector2(lower_b.y(), -lower_b.x()) * (along_a / det);
  const Vector2 column_b = Vector2(-lower_a.y(), lower_a.x()) * (along_b / det);

  const double c = std::cos(q.tilt), s = g.tilt_sign * std::sin(q.tilt);
  const double D = foot.y() + g.axis_to_shoulder_down, a = g.axis_to_plane_out;
  Matrix3 J;
  J.col(0) = g.tilt_sign * Vector3(0, g.side * (D * c - a * s), D * s + a * c);
  J.col(1) = Vector3(column_a.x(), g.side * s * column_a.y(), -c * column_a.y());
  J.col(2) = Vector3(column_b.x(), g.side * s * column_b.y(), -c * column_b.y());
  return J;
}

LegMargins leg_margins(const FiveBarGeometry& g, const LegAngles& q) noexcept {
  ChainLinks a, b;
  a.upper = upper_link(g.a, q.shoulder_left);
  b.upper = upper_link(g.b, q.shoulder_right);
  a.lower = lower_link(g.a, a.upper, q.elbow_left);
  b.lower = lower_link(g.b, b.upper, q.elbow_right);
  return {
      std::min({limit_margin(q.tilt, g.tilt_limits), limit_margin(q.shoulder_left, g.a.shoulder_limits),
                limit_margin(q.shoulder_right, g.b.shoulder_limits),
                limit_margin(q.elbow_left, g.a.elbow_limits), limit_margin(q.elbow_right, g.b.elbow_limits)}),
      std::min(elbow_margin(a), elbow_margin(b)),
      std::atan2(std::abs(cross(a.lower, b.lower)), std::abs(a.lower.dot(b.lower)))};
}

}  // namespace crossgait
