#include "ik/five_bar_leg.h"

#include <algorithm>
#include <cmath>

namespace crossgait {
namespace {

/// @returns whether anything changed.
bool clamp_to_limits(const FiveBarGeometry& g, ServoAngles& q) {
  bool changed = g.has_tilt && clamp_angle(q.tilt, g.tilt_limits);
  changed |= clamp_angle(q.shoulder_left, g.a.shoulder_limits);
  changed |= clamp_angle(q.shoulder_right, g.b.shoulder_limits);
  return changed;
}

// Writes what the joints' limits leave of a placed leg's angles; `limited` is set if one binds.
ServoSolution servo_solution(const FiveBarGeometry& g, const PlacedLeg& leg, bool& limited) {
  ServoSolution solution{leg.status, {leg.tilt, shoulder_angle(g.a, leg.a), shoulder_angle(g.b, leg.b)}};
  limited = clamp_to_limits(g, solution.angles);
  if (limited && leg.status == IkStatus::kOk) solution.status = IkStatus::kClampedJointLimit;
  return solution;
}

}  // namespace

PlacedLeg place_leg(const FiveBarGeometry& g, const Vector3& target, WorkingMode mode) noexcept {
  PlacedLeg leg;
  Vector3 p = target;
  if (!target.allFinite()) {
    leg.status = IkStatus::kInvalidTarget;
    p = {0, 0, -(g.a.upper + g.a.lower + g.b.upper + g.b.lower) / 3};
  }
  p = p.cwiseMax(-kFar).cwiseMin(kFar);
  Vector2 foot(p.x(), -p.z());
  IkStatus aside = IkStatus::kOk;
  if (g.has_tilt) {
    // Not above the shoulders.
    const double b = g.axis_to_shoulder_down;
    const TiltedPlane plane = plane_through(g, p.y(), p.z(), std::max(b, 0.0));
    leg.tilt = plane.tilt;
    leg.c = plane.c;
    leg.s = plane.s;
    foot.y() = plane.D - b;
    if (plane.too_near) aside = IkStatus::kClampedTooNear;
  } else if (std::abs(p.y()) > kOffPlane) {
    aside = IkStatus::kClampedTooFar;
  }
  IkStatus clamped = clamp_to_workspace(g, foot);
  if (clamped == IkStatus::kOk) clamped = aside;
  if (leg.status == IkStatus::kOk) leg.status = clamped;
  const ElbowSigns signs = elbow_signs(mode);
  leg.foot = foot;
  leg.a = place_links(g.a, foot, signs.a);
  leg.b = place_links(g.b, foot, signs.b);
  return leg;
}

ServoSolution servos_of(const FiveBarGeometry& g, const PlacedLeg& leg) noexcept {
  bool limited = false;
  return servo_solution(g, leg, limited);
}

ServoSolution solve_servos(const FiveBarGeometry& g, const Vector3& target, WorkingMode mode) noexcept {
  return servos_of(g, place_leg(g, target, mode));
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
  const double outward = g.has_tilt ? tilt : 0;
  return {closure.closed, tilted(g, closure.foot, std::cos(outward), g.tilt_sign * std::sin(outward)),
          elbow_angle(g.a, closure.a), elbow_angle(g.b, closure.b)};
}

Matrix3 leg_jacobian(const FiveBarGeometry& g, const LegAngles& q) noexcept {
  PlacedLeg leg;
  leg.a.upper = upper_link(g.a, q.shoulder_left);
  leg.b.upper = upper_link(g.b, q.shoulder_right);
  leg.a.lower = lower_link(g.a, leg.a.upper, q.elbow_left);
  leg.b.lower = lower_link(g.b, leg.b.upper, q.elbow_right);
  leg.foot = Vector2(g.a.shoulder_x, 0) + leg.a.upper + leg.a.lower;
  leg.tilt = g.has_tilt ? q.tilt : 0;
  leg.c = std::cos(leg.tilt);
  leg.s = g.tilt_sign * std::sin(leg.tilt);
  return leg_jacobian(g, leg);
}

Matrix3 leg_jacobian(const FiveBarGeometry& g, const PlacedLeg& leg) noexcept {
  // lower_i . foot' = lower_i . elbow_i', with elbow_i' = (upper_i turned by a right angle) times the plane
  // angle's rate.
  const Vector2 &lower_a = leg.a.lower, &lower_b = leg.b.lower;
  const double along_a = g.a.shoulder_sign * cross(leg.a.upper, lower_a);
  const double along_b = g.b.shoulder_sign * cross(leg.b.upper, lower_b);
  const double det = cross(lower_a, lower_b);
  const Vector2 column_a = Vector2(lower_b.y(), -lower_b.x()) * (along_a / det);
  const Vector2 column_b = Vector2(-lower_a.y(), lower_a.x()) * (along_b / det);

  Matrix3 J;
  J.col(0) = g.has_tilt ? tilt_column(g, leg.foot.y(), leg.c, leg.s) : Vector3(Vector3::Zero());
  J.col(1) = tilted_velocity(g, column_a, leg.c, leg.s);
  J.col(2) = tilted_velocity(g, column_b, leg.c, leg.s);
  return J;
}

LegMargins leg_margins(const FiveBarGeometry& g, const LegAngles& q) noexcept {
  ChainLinks a, b;
  a.upper = upper_link(g.a, q.shoulder_left);
  b.upper = upper_link(g.b, q.shoulder_right);
  a.lower = lower_link(g.a, a.upper, q.elbow_left);
  b.lower = lower_link(g.b, b.upper, q.elbow_right);
  LegMargins margins{
      std::min({limit_margin(q.shoulder_left, g.a.shoulder_limits),
                limit_margin(q.shoulder_right, g.b.shoulder_limits),
                limit_margin(q.elbow_left, g.a.elbow_limits), limit_margin(q.elbow_right, g.b.elbow_limits)}),
      std::min(elbow_margin(a), elbow_margin(b)),
      std::atan2(std::abs(cross(a.lower, b.lower)), std::abs(a.lower.dot(b.lower)))};
  if (g.has_tilt) margins.joint_limit = std::min(margins.joint_limit, limit_margin(q.tilt, g.tilt_limits));
  return margins;
}

WorkingMode working_mode_of(const FiveBarGeometry& g, const LegAngles& q) noexcept {
  const auto bends_up = [](const TwoLinkChain& chain, double shoulder, double elbow) {
    const Vector2 upper = upper_link(chain, shoulder);
    return cross(upper, lower_link(chain, upper, elbow)) >= 0;
  };
  const bool a = bends_up(g.a, q.shoulder_left, q.elbow_left),
             b = bends_up(g.b, q.shoulder_right, q.elbow_right);
  if (a == b) return a ? WorkingMode::kBothUp : WorkingMode::kBothDown;
  return a ? WorkingMode::kUpDown : WorkingMode::kDownUp;
}

}  // namespace crossgait
