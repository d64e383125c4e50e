#include "ik/least_squares_leg.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "ik/leg_frames.h"
#include "physics/robot/followed_joint.h"

namespace crossgait {
namespace {

constexpr int kMaxIterations = 60;
constexpr double kAside = 0.02;     // sine of a hip axis' slope, that of files of two decimals
constexpr double kStraight = 0.05;  // rad, bend of a knee that does not tell its side

std::size_t slot(int i) { return static_cast<std::size_t>(i); }

/// Where the joints and the foot of a posture are, in the leg frame.
struct PlacedChain {
  std::array<Vector3, 4> origins, axes;
  Vector3 foot;
};

/// The servo that moves a joint, and how many times as far.
int variable_of(const LegLink& link, int i) { return link.leader == -1 ? i : link.leader; }
double share_of(const LegLink& link) { return link.leader == -1 ? 1 : link.multiplier; }

PlacedChain place_chain(const LeastSquaresLegGeometry& g, const LegJointAngles& q) {
  PlacedChain chain;
  Matrix3 R = Matrix3::Identity();
  Vector3 p = Vector3::Zero();
  for (int i = 0; i < g.count; ++i) {
    const LegLink& link = g.links[slot(i)];
    p += R * link.p;
    R = R * link.R;
    chain.origins[slot(i)] = p;
    chain.axes[slot(i)] = R * link.axis;
    R = R * Eigen::AngleAxisd(g.angle(i, q), link.axis).toRotationMatrix();
  }
  chain.foot = p + R * g.p_foot;
  return chain;
}

/// d foot / d angle of each joint, whatever moves it.
using JointColumns = std::array<Vector3, 4>;

JointColumns columns_of(const LeastSquaresLegGeometry& g, const PlacedChain& chain) {
  JointColumns columns;
  for (int i = 0; i < g.count; ++i)
    columns[slot(i)] = chain.axes[slot(i)].cross(chain.foot - chain.origins[slot(i)]);
  return columns;
}

Matrix3 jacobian(const LeastSquaresLegGeometry& g, const PlacedChain& chain) {
  const JointColumns columns = columns_of(g, chain);
  Matrix3 J = Matrix3::Zero();
  for (int i = 0; i < g.count; ++i)
    J.col(variable_of(g.links[slot(i)], i)) += share_of(g.links[slot(i)]) * columns[slot(i)];
  return J;
}

/// Which joint is the hip: of the two before the knee the one that is more nearly parallel to it at zero.
int hip_of(const LeastSquaresLegGeometry& g) {
  if (g.knee_place() == 1) return 0;
  const Matrix3 R_01 = g.links[1].R, R_12 = g.links[2].R;
  const Vector3 knee = R_01 * R_12 * g.links[2].axis;  // in the first joint's frame
  return std::abs(knee.dot(g.links[0].axis)) > std::abs(knee.dot(R_01 * g.links[1].axis)) ? 0 : 1;
}

/// +1 if the knee's axis points towards +y at zero angles, else -1.
double knee_axis_sign(const LeastSquaresLegGeometry& g) {
  Matrix3 R = Matrix3::Identity();
  for (int i = 0; i <= g.knee_place(); ++i) R = R * g.links[slot(i)].R;
  return std::copysign(1.0, (R * g.links[slot(g.knee_place())].axis).y());
}

/// Angle from thigh to shin about the knee's axis, rad: of a leg with an ankle the shin ends there, so that
/// the bend is the knee's angle less a constant in every leg.
double bend_about_axis(const LeastSquaresLegGeometry& g, const PlacedChain& chain) {
  const auto knee = slot(g.knee_place());
  const Vector3& axis = chain.axes[knee];
  const Vector3 end = g.knee_place() + 1 < g.count ? chain.origins[knee + 1] : chain.foot;
  const Vector3 thigh = chain.origins[knee] - chain.origins[knee - 1], shin = end - chain.origins[knee];
  const Vector3 across = axis.cross(thigh);  // thigh's part across the axis, turned by a right angle
  return std::atan2(across.dot(shin), across.cross(axis).dot(shin));
}

using Limits = std::array<JointLimits, 3>;

constexpr JointLimits kUnlimited{-1e9, 1e9};  // rad; finite, so that nothing becomes a NaN

/// Limits as a search sees them: those of a joint that can turn all the way round are none.
Limits limits_of(const LeastSquaresLegGeometry& g) {
  constexpr double kWholeTurn = 2 * M_PI - 1e-9;
  Limits limits;
  for (int i = 0; i < g.servos(); ++i) {
    const JointLimits& own = g.links[slot(i)].limits;
    limits[slot(i)] = own.upper - own.lower >= kWholeTurn ? kUnlimited : own;
  }
  return limits;
}

LegJointAngles clamped(const LeastSquaresLegGeometry& g, const Limits& limits, LegJointAngles q) {
  for (int i = 0; i < g.servos(); ++i) clamp_angle(q[i], limits[slot(i)]);
  return q;
}

/// `limits` with the knee kept on the side of `q`'s: its bend is its angle less a constant, and from straight
/// to folded.
Limits on_side(const LeastSquaresLegGeometry& g, Limits limits, const LegJointAngles& q, double side) {
  const LegLink& knee = g.links[slot(g.knee_place())];
  const int moved_by = variable_of(knee, g.knee_place());
  const double share = share_of(knee);
  if (share == 0) return limits;
  const double straight = q[moved_by] - bend_about_axis(g, place_chain(g, q)) / share,
               folded = straight + side * M_PI / share;
  JointLimits& own = limits[slot(moved_by)];
  own = {std::clamp(std::min(straight, folded), own.lower, own.upper),
         std::clamp(std::max(straight, folded), own.lower, own.upper)};
  return limits;
}

/// Within the joints' limits, by whole turns where that does it; the third angle of two is zero.
LegJointAngles fitted(const LeastSquaresLegGeometry& g, LegJointAngles q) {
  for (int i = 0; i < g.servos(); ++i) fit_angle(q[i], g.links[slot(i)].limits);
  if (g.servos() == 2) q[2] = 0;
  return q;
}

/// A posture of a search and how far its foot is from the target.
struct Found {
  LegJointAngles q;
  PlacedChain chain;
  double error;  // m
};

Found look(const LeastSquaresLegGeometry& g, const Vector3& target, const LegJointAngles& q,
           int& iterations) {
  ++iterations;
  Found found{q, place_chain(g, q), 0};
  found.error = (target - found.chain.foot).norm();
  return found;
}

/// Step of the joints that are free. The matrix is half the second derivative of |error|^2, J'J less what the
/// curvature of the foot's way makes of the error (d2 foot / dqi dqj = axis_i x J_j, i before j), so that a
/// target out of reach is approached as fast as one within; where that is not positive definite, J'J alone.
/// Damped by `lambda`.
Vector3 damped_step(const LeastSquaresLegGeometry& g, const Limits& limits, const Vector3& target,
                    const Found& at, double lambda) {
  const Matrix3 J = jacobian(g, at.chain);
  const JointColumns columns = columns_of(g, at.chain);
  const Vector3 error = target - at.chain.foot;
  Vector3 downhill = J.transpose() * error;
  Matrix3 gauss = J.transpose() * J, curvature = Matrix3::Zero();
  for (int i = 0; i < g.count; ++i) {
    for (int j = i; j < g.count; ++j) {
      const LegLink &first = g.links[slot(i)], &second = g.links[slot(j)];
      const int a = variable_of(first, i), b = variable_of(second, j);
      const double part =
          share_of(first) * share_of(second) * at.chain.axes[slot(i)].cross(columns[slot(j)]).dot(error);
      curvature(a, b) += part;
      if (i != j) curvature(b, a) += part;
    }
  }
  for (int i = 0; i < 3; ++i) {
    const bool held = i >= g.servos() || (downhill[i] < 0 && at.q[i] <= limits[slot(i)].lower) ||
                      (downhill[i] > 0 && at.q[i] >= limits[slot(i)].upper);
    if (!held) continue;
    downhill[i] = 0;
    for (Matrix3* m : {&gauss, &curvature}) {
      m->row(i).setZero();
      m->col(i).setZero();
    }
    gauss(i, i) = 1;
  }
  gauss.diagonal().array() += lambda;
  const Eigen::LLT<Matrix3> newton(gauss - curvature);
  if (newton.info() == Eigen::Success) return newton.solve(downhill);
  return gauss.llt().solve(downhill);
}

/// From `q`, which is within `limits`, to the nearest posture downhill.
Found search(const LeastSquaresLegGeometry& g, const Limits& limits, const Vector3& target,
             const LegJointAngles& q, int& iterations) {
  Found best = look(g, target, q, iterations);
  const double scale = jacobian(g, best.chain).squaredNorm() + 1e-12;  // m^2; a foot on all axes cannot move
  double lambda = 1e-3 * scale;
  for (int i = 1; i < kMaxIterations && best.error > kConverged / 10 && lambda < 1e9 * scale; ++i) {
    const Vector3 step = damped_step(g, limits, target, best, lambda);
    const Found next = look(g, target, clamped(g, limits, best.q + step), iterations);
    if (next.error < best.error) {
      // What is gained has become rounding.
      const bool arrived = best.error - next.error < 1e-15;
      best = next;
      lambda = std::max(lambda / 10, 1e-15 * scale);
      if (arrived) break;
    } else {
      lambda *= 10;
    }
  }
  return best;
}

/// `q` with its knee bent by `bend` about its axis.
LegJointAngles with_bend(const LeastSquaresLegGeometry& g, LegJointAngles q, double bend) {
  const LegLink& knee = g.links[slot(g.knee_place())];
  if (share_of(knee) == 0) return q;
  q[variable_of(knee, g.knee_place())] += (bend - bend_about_axis(g, place_chain(g, q))) / share_of(knee);
  return q;
}

/// Where the knee of `q` bends to about its axis, +1 or -1. One that is next to straight or folded goes where
/// its limits leave more room.
double side_of(const LeastSquaresLegGeometry& g, const LegJointAngles& q) {
  const double bend = bend_about_axis(g, place_chain(g, q));
  if (std::abs(bend) >= kStraight && std::abs(bend) <= M_PI - kStraight) return std::copysign(1.0, bend);
  const auto room = [&](double side) {
    const Limits limits = on_side(g, limits_of(g), q, side);
    const JointLimits& own = limits[slot(variable_of(g.links[slot(g.knee_place())], g.knee_place()))];
    return own.upper - own.lower;
  };
  const double least = room(1.0) - room(-1.0);
  return std::abs(least) > kStraight ? std::copysign(1.0, least) : std::copysign(1.0, bend);
}

/// Why the joints cannot get nearer; see solve_least_squares.
IkStatus shortfall(const LeastSquaresLegGeometry& g, const Vector3& target, const Found& best, double side,
                   int& iterations) {
  Limits none;
  none.fill(kUnlimited);
  const Found unlimited = search(g, on_side(g, none, best.q, side), target, best.q, iterations);
  if (unlimited.error <= kConverged) return IkStatus::kClampedJointLimit;
  const PlacedChain& chain = unlimited.chain;
  const Vector3 leg = chain.foot - chain.origins[slot(hip_of(g))];
  const double along = (target - chain.foot).dot(leg) / (unlimited.error * leg.norm());
  if (std::abs(along) > 0.5) return along > 0 ? IkStatus::kClampedTooFar : IkStatus::kClampedTooNear;
  if (g.servos() == 2) return IkStatus::kClampedTooFar;  // beside the surface that the foot moves on
  const auto from_axis = [&](const Vector3& p) { return chain.axes[0].cross(p - chain.origins[0]).norm(); };
  return from_axis(target) < from_axis(chain.foot) ? IkStatus::kClampedTooNear : IkStatus::kClampedTooFar;
}

/// Makes a joint of the chain one that follows a servo of it, along what it follows, and keeps that servo
/// where the joint is within its limits.
void follow(const RobotDescription& robot, const LegFrames& frames, const SerialChain& chain, int i,
            LeastSquaresLegGeometry& g) {
  LegLink& link = g.links[slot(i)];
  const std::string& name = robot.joint(chain.joints[slot(i)]).name;
  const std::span servos = std::span(chain.joints).first(slot(chain.servos));
  const FollowedJoint followed = follow_couplings(robot, chain.joints[slot(i)], servos);
  if (!followed.is_one_of_them) frames.fail(name, "a joint that follows a servo of its leg", "another one");
  link.multiplier = followed.multiplier, link.offset = followed.offset;
  link.leader = static_cast<int>(std::ranges::find(servos, followed.joint) - servos.begin());
  if (link.multiplier == 0) return;
  const double a = (link.limits.lower - link.offset) / link.multiplier,
               b = (link.limits.upper - link.offset) / link.multiplier;
  JointLimits& own = g.links[slot(link.leader)].limits;
  own = {std::max(own.lower, std::min(a, b)), std::min(own.upper, std::max(a, b))};
  if (!(own.lower < own.upper))
    frames.fail(
        name,
        fmt::format("limits that leave angles to '{}', which it follows", robot.joint(followed.joint).name),
        "none");
}

}  // namespace

LeastSquaresLegGeometry least_squares_leg_geometry(const RobotDescription& robot, Leg leg,
                                                   const SerialLegJoints& joints,
                                                   const LegJointAngles& home) {
  validate(robot, leg, joints);
  const LegFrames frames(robot, leg, 0);
  LeastSquaresLegGeometry g;
  const SerialChain chain = chain_of(joints);
  g.count = chain.count;
  g.p_foot = joints.p_BF;
  for (int i = 0; i < g.count; ++i) {
    const int joint = chain.joints[slot(i)];
    const Body& body = frames.at(joint + 1);
    g.links[slot(i)] = {
        body.X_PB.linear(), body.X_PB.translation(), body.joint.axis, frames.limits(joint), -1, 1, 0};
    if (i >= chain.servos) follow(robot, frames, chain, i, g);
  }
  g.knee = joints.ankle == -1 ? -1 : g.count - 2;
  // The links are still placed in the base frame.
  const auto hip = slot(chain.hip);
  PlacedChain zero = place_chain(g, LegJointAngles::Zero());
  // Files may have a leg aside at zero angles: its frame is that of the leg upright.
  if (chain.hip == 1 && std::abs(zero.axes[1].z()) > kAside)
    zero = place_chain(g, {levelling_angle(zero.axes[0], zero.axes[1]), 0, 0});
  g.p_BL = zero.origins[hip] + zero.axes[hip] * zero.axes[hip].dot(zero.foot - zero.origins[hip]);
  g.links[0].p -= g.p_BL;

  const PlacedChain at_home = place_chain(g, home);
  const auto knee = slot(g.knee_place());
  if (!(zero.axes[knee].cross(zero.foot - zero.origins[knee]).norm() > 0)) {
    frames.fail("shin", "a foot off the axis of the knee", "a foot on it");
  }
  const double bend = bend_about_axis(g, at_home);
  if (!home.allFinite() || std::abs(bend) < kStraight || std::abs(bend) > M_PI - kStraight) {
    frames.fail("home", "a knee bent by 0.05 rad or more", fmt::format("{:g} rad", bend));
  }
  const bool forward = knee_axis_sign(g) * bend > 0;
  g.starts[forward ? 0 : 1] = home;
  const LegJointAngles mirrored = with_bend(g, home, -bend);
  const LeastSquaresSolution other = solve_least_squares(g, at_home.foot, mirrored);
  g.starts[forward ? 1 : 0] = other.status == IkStatus::kOk ? other.angles : fitted(g, mirrored);
  return g;
}

LeastSquaresSolution solve_least_squares(const LeastSquaresLegGeometry& g, const Vector3& target,
                                         const LegJointAngles& start) noexcept {
  LegJointAngles from = start;
  for (int i = 0; i < g.servos(); ++i) {
    const JointLimits& own = g.links[slot(i)].limits;
    if (!std::isfinite(from[i])) from[i] = (own.lower + own.upper) / 2;
  }
  from = fitted(g, from);
  LeastSquaresSolution solution{IkStatus::kInvalidTarget, from, 0};
  if (!target.allFinite()) return solution;
  const Vector3 p = target.cwiseMax(-kFar).cwiseMin(kFar);

  const double side = side_of(g, from);
  const int hip = hip_of(g);
  const auto search_from = [&](const LegJointAngles& q) {
    const Limits limits = on_side(g, limits_of(g), q, side);
    return search(g, limits, p, clamped(g, limits, q), solution.iterations);
  };
  Found best = search_from(from);
  // The knee bent by a right angle, the hip where it was, to either side of that and opposite to it.
  for (const double turn : {0.0, 1.5, -1.5, 3.0}) {
    if (best.error <= kConverged) break;
    LegJointAngles other = with_bend(g, from, side * M_PI_2);
    other[hip] += turn;
    const Found found = search_from(fitted(g, other));
    if (found.error < best.error) best = found;
  }
  solution.angles = fitted(g, best.q);
  solution.status =
      best.error <= kConverged ? IkStatus::kOk : shortfall(g, p, best, side, solution.iterations);
  return solution;
}

Vector3 forward_least_squares(const LeastSquaresLegGeometry& g, const LegJointAngles& q) noexcept {
  return place_chain(g, q).foot;
}

Matrix3 least_squares_jacobian(const LeastSquaresLegGeometry& g, const LegJointAngles& q) noexcept {
  return jacobian(g, place_chain(g, q));
}

LegMargins least_squares_margins(const LeastSquaresLegGeometry& g, const LegJointAngles& q) noexcept {
  LegMargins margins{limit_margin(q[0], g.links[0].limits), 0, M_PI_2};
  for (int i = 1; i < g.servos(); ++i) {
    margins.joint_limit = std::min(margins.joint_limit, limit_margin(q[i], g.links[slot(i)].limits));
  }
  const double bend = std::abs(bend_about_axis(g, place_chain(g, q)));
  margins.serial = std::min(bend, M_PI - bend);
  return margins;
}

double knee_bend(const LeastSquaresLegGeometry& g, const LegJointAngles& q) noexcept {
  return knee_axis_sign(g) * bend_about_axis(g, place_chain(g, q));
}

}  // namespace crossgait
