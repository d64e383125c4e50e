// Kinematics of a leg of which loops move a joint (physics/robot/closed_chain.h), by damped least squares
// from the robot's home posture.
#pragma once

#include <optional>

#include "ik/ik_status.h"
#include "ik/serial_leg.h"
#include "physics/robot/closed_chain.h"

namespace crossgait {

struct ClosedChainGeometry {
  ClosedChain chain;
  ClosedChain::Angles home;  ///< closed; every search starts from there, and keeps to the side on which it is
  /// Origin of the leg frame in the base frame, m: the point of the hip axis nearest to the foot at home.
  Vector3 p_BL = Vector3::Zero();
  int hip = 0, knee = 1;  ///< places among the chain's Angles
};

/// @throws ConfigError naming file and leg if its loops are open at home, leave a joint free that has no
/// servo,
///   or the foot cannot be moved by all servos
ClosedChainGeometry closed_chain_geometry(const RobotDescription& robot, Leg leg);

struct ClosedChainSolution {
  IkStatus status = IkStatus::kOk;
  ClosedChain::Angles angles;
};

/// Finds the joint angles that put the foot's centre on `target` to `kConverged`, sought from home by
/// Levenberg and Marquardt's method within the limits of servos and of the joints that they move. Short of
/// the target the posture is the nearest one found, and the status kClampedJointLimit if a joint is at a
/// limit, else kClampedTooNear or kClampedTooFar as the target is nearer to the hip than the foot or not.
/// Never NaN.
/// @param target  foot centre in the leg frame, m; not finite: home, kInvalidTarget
[[nodiscard]] ClosedChainSolution solve_closed_chain(const ClosedChainGeometry& geometry,
                                                     const Vector3& target) noexcept;

/// Moves the servos from home to these angles. @returns nothing where the loops cannot follow them all the
/// way
[[nodiscard]] std::optional<ClosedChain::Angles> follow_servos(
    const ClosedChainGeometry& geometry, const ClosedChain::ServoAngles& servos) noexcept;

/// Returns margins: `serial` of the knee from straight or folded, seen along its axis, `parallel` the chain's
/// transmission.
LegMargins closed_chain_margins(const ClosedChainGeometry& geometry,
                                const ClosedChain::Angles& angles) noexcept;

/// Tells to which side the knee is bent at home.
KneeBranch closed_chain_knee(const ClosedChainGeometry& geometry) noexcept;

}  // namespace crossgait
