#include "ik/closed_chain_leg.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "ik/leg_frames.h"

namespace crossgait {
namespace {

using Angles = ClosedChain::Angles;
using Servos = ClosedChain::ServoAngles;

constexpr int kMostAttempts = 60;
constexpr double kLargestStep = 0.5;  // rad, of a servo
constexpr double kAtLimit = 1e-9;     // rad

bool is_at_a_limit(const ClosedChain& chain, const Angles& q) {
  constexpr double kNear = 1e-6;  // rad: of a passive joint the search ends next to it
  return ((q - chain.lower()).array() < kNear).any() || ((chain.upper() - q).array() < kNear).any();
}

/// Step towards the target of the servos that no limit holds, damped by `lambda`.
Servos damped_step(const ClosedChain& chain, const Angles& q, const Vector3& error, double lambda) {
  const ClosedChain::FootJacobian J = chain.jacobian(q);
  const int servos = chain.servo_count();
  Servos downhill = J.transpose() * error;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3> normal = J.transpose() * J;
  for (int i = 0; i < servos; ++i) {
    const bool held = (downhill[i] < 0 && q[i] <= chain.lower()[i] + kAtLimit) ||
                      (downhill[i] > 0 && q[i] >= chain.upper()[i] - kAtLimit);
    if (!held) continue;
    downhill[i] = 0;
    normal.row(i).setZero();
    normal.col(i).setZero();
    normal(i, i) = 1;
  }
  normal.diagonal().array() += lambda;
  Servos step = normal.llt().solve(downhill);
  const double largest = step.cwiseAbs().maxCoeff();
  if (largest > kLargestStep) step *= kLargestStep / largest;
  return step;
}

/// Angle from thigh to shin about +y as far as the knee's axis goes that way, rad: positive if the knee is
/// ahead.
double knee_bend(const ClosedChainGeometry& g, const Angles& q) {
  Vector3 axis = g.chain.axis(q, g.knee);
  if (axis.y() < 0) axis = -axis;
  const Vector3 knee = g.chain.origin(q, g.knee);
  const Vector3 thigh = axis.cross(knee - g.chain.origin(q, g.hip)),
                shin = axis.cross(g.chain.foot(q) - knee);
  return std::atan2(axis.dot(thigh.cross(shin)), thigh.dot(shin));
}

}  // namespace

ClosedChainGeometry closed_chain_geometry(const RobotDescription& robot, Leg leg) {
  const LegModel& model = (*robot.legs)[leg];
  const LegFrames frames(robot, leg, 0);
  ClosedChainGeometry g;
  g.chain = ClosedChain(robot, leg);
  if (robot.home.size() != robot.joint_count())
    frames.fail("home", fmt::format("{} joint angles", robot.joint_count()),
                fmt::format("{}", robot.home.size()));
  const std::vector<int> joints = model.joints();
  g.home = Angles::Zero(static_cast<Eigen::Index>(joints.size()));
  for (std::size_t i = 0; i < joints.size(); ++i)
    g.home[static_cast<Eigen::Index>(i)] = robot.home[joints[i]];
  if (!g.chain.close(g.home)) frames.fail("home", "loops that close", "open ones");
  if (const int loose = g.chain.loose_joints(g.home); loose > 0)
    frames.fail("joints", "loops that move every joint without a servo",
                fmt::format("{} that would move by itself", loose));
  g.hip = model.place("hip"), g.knee = model.place("knee");
  const Vector3 hip = g.chain.origin(g.home, g.hip), axis = g.chain.axis(g.home, g.hip);
  g.p_BL = hip + axis * axis.dot(g.chain.foot(g.home) - hip);
  return g;
}

ClosedChainSolution solve_closed_chain(const ClosedChainGeometry& g, const Vector3& target) noexcept {
  const ClosedChain& chain = g.chain;
  ClosedChainSolution solution{IkStatus::kInvalidTarget, g.home};
  if (!target.allFinite()) return solution;
  const Vector3 p = g.p_BL + target.cwiseMax(-kFar).cwiseMin(kFar);
  Angles& q = solution.angles;
  Vector3 off = p - chain.foot(q);
  const double scale = chain.jacobian(q).squaredNorm() + 1e-12;  // m^2
  double lambda = 1e-4 * scale;
  for (int i = 0; i < kMostAttempts && off.norm() > kConverged / 10 && lambda < 1e9 * scale; ++i) {
    const Servos step = damped_step(chain, q, off, lambda);
    const int servos = chain.servo_count();
    const Servos goal =
        (q.head(servos) + step).cwiseMax(chain.lower().head(servos)).cwiseMin(chain.upper().head(servos));
    Angles next = q;
    const bool moved = chain.move(goal, next) && chain.is_within_limits(next, kAtLimit);
    const Vector3 next_off = p - chain.foot(next);
    if (moved && next_off.norm() < off.norm()) {
      const bool arrived = off.norm() - next_off.norm() < 1e-15;
      q = next;
      off = next_off;
      lambda = std::max(lambda / 10, 1e-15 * scale);
      if (arrived) break;
    } else {
      lambda *= 10;
    }
  }
  if (off.norm() <= kConverged) {
    solution.status = IkStatus::kOk;
  } else if (is_at_a_limit(chain, q)) {
    solution.status = IkStatus::kClampedJointLimit;
  } else {
    const Vector3 hip = chain.origin(q, g.hip);
    const bool too_near = (p - hip).norm() < (chain.foot(q) - hip).norm();
    solution.status = too_near ? IkStatus::kClampedTooNear : IkStatus::kClampedTooFar;
  }
  return solution;
}

std::optional<Angles> follow_servos(const ClosedChainGeometry& g, const Servos& servos) noexcept {
  Angles q = g.home;
  return g.chain.move(servos, q) ? std::optional(q) : std::nullopt;
}

LegMargins closed_chain_margins(const ClosedChainGeometry& geometry, const Angles& angles) noexcept {
  LegMargins margins{M_PI, 0, geometry.chain.transmission(angles)};
  for (Eigen::Index i = 0; i < angles.size(); ++i)
    margins.joint_limit = std::min(margins.joint_limit, std::min(angles[i] - geometry.chain.lower()[i],
                                                                 geometry.chain.upper()[i] - angles[i]));
  const double bend = std::abs(knee_bend(geometry, angles));
  margins.serial = std::min(bend, M_PI - bend);
  return margins;
}

KneeBranch closed_chain_knee(const ClosedChainGeometry& g) noexcept {
  return knee_bend(g, g.home) > 0 ? KneeBranch::kForward : KneeBranch::kBackward;
}

}  // namespace crossgait
