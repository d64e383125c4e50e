// Kinematics of a serial leg of two or three servos about any axes, by damped least squares: for legs that
// ik/serial_leg.h does not cover, of which joints may follow others as well.
#pragma once

#include <array>

#include "ik/serial_leg.h"

namespace crossgait {

/// Describes a joint: its frame in that of the joint before, at zero angle; the first's in the leg frame.
struct LegLink {
  Matrix3 R = Matrix3::Identity();
  Vector3 p = Vector3::Zero();      ///< m
  Vector3 axis = Vector3::UnitZ();  ///< unit, in the joint's own frame
  JointLimits limits;               ///< of a servo: those of what follows it in them
  int leader = -1;  ///< place in the chain of the servo that the joint follows; -1: it has one
  double multiplier = 1, offset = 0;  ///< its angle is multiplier times the leader's plus offset, rad
};

/// Angles of the servos in the order of the chain: abduction, hip, knee; hip, abduction, knee; or two of them
/// (hip, knee; or abduction, hip) and a zero.
using LegJointAngles = Vector3;

struct LeastSquaresLegGeometry {
  /// Origin of the leg frame in the base frame, m: the point of the hip axis nearest to the foot at zero
  /// angles, the abduction such that this axis is level. For legs that the closed form covers it is the same
  /// point.
  Vector3 p_BL = Vector3::Zero();
  int count = 3;  ///< joints, 2 to 4: servos, then those that follow
  int knee = -1;  ///< place of the knee; -1: it is the last one
  std::array<LegLink, 4> links;
  Vector3 p_foot = Vector3::Zero();  ///< foot centre in the last joint's frame, m
  /// A posture with its knee forward and one with its knee backward, from which solutions are sought; a side
  /// that the knee's limits forbid has a posture at its limit.
  std::array<LegJointAngles, 2> starts{LegJointAngles::Zero(), LegJointAngles::Zero()};

  int knee_place() const { return knee == -1 ? count - 1 : knee; }
  /// Counts the joints that have a servo, 2 or 3.
  int servos() const {
    int found = 0;
    for (int i = 0; i < count; ++i) found += links[static_cast<std::size_t>(i)].leader == -1 ? 1 : 0;
    return found;
  }
  /// Returns the angle of a joint, rad. @param q  of the servos
  double angle(int i, const LegJointAngles& q) const {
    const LegLink& link = links[static_cast<std::size_t>(i)];
    return link.leader == -1 ? q[i] : link.multiplier * q[link.leader] + link.offset;
  }

  const LegJointAngles& start(KneeBranch branch) const {
    return starts[branch == KneeBranch::kForward ? 0 : 1];
  }
};

/// @param home  a posture of the leg with its knee bent; the other branch's start has it bent the other
///   way and, if it can, its foot where it is in `home`
/// @throws ConfigError naming file, leg and joint if the joints do not hang on each other or on the base, the
///   foot does not move with the knee, the knee of `home` is straight to 0.05 rad, which tells no branch, or
///   a joint that follows leaves no angle to its servo
LeastSquaresLegGeometry least_squares_leg_geometry(const RobotDescription& robot, Leg leg,
                                                   const SerialLegJoints& joints, const LegJointAngles& home);

struct LeastSquaresSolution {
  IkStatus status = IkStatus::kOk;
  LegJointAngles angles = LegJointAngles::Zero();
  int iterations = 0;  ///< evaluations of the forward kinematics, over all attempts
};

/// Finds joint angles that put the foot's centre on `target` to `kConverged`, sought from `start` (moved into
/// the joint limits) by Levenberg and Marquardt's method in the variables' box: joints at a limit that the
/// step would pass are held. The knee stays on the side to which it is bent in `start`; one that is straight
/// or folded to 0.05 rad goes where its limits leave more room. Where a search ends away from the target
/// others start from other postures, at most five in all of at most 60 iterations each; the nearest posture
/// is the answer. Of feet at random over the whole range of a robot's joints about 2 in 1000 are missed from
/// its home posture.
///
/// Short of the target, the status is kClampedJointLimit if the joints without limits would get there from
/// the same posture, else kClampedTooNear or kClampedTooFar: whether the target is nearer to the hip than the
/// foot, or beside it and nearer to the first axis. Never NaN, and the same answer for the same arguments; at
/// the workspace's edge it need not be continuous in the target.
/// @param target  foot centre in the leg frame, m; not finite: `start` within its limits, kInvalidTarget
[[nodiscard]] LeastSquaresSolution solve_least_squares(const LeastSquaresLegGeometry& geometry,
                                                       const Vector3& target,
                                                       const LegJointAngles& start) noexcept;

/// Starts from the posture that the geometry holds for this branch.
[[nodiscard]] inline LeastSquaresSolution solve_least_squares(const LeastSquaresLegGeometry& geometry,
                                                              const Vector3& target,
                                                              KneeBranch branch) noexcept {
  return solve_least_squares(geometry, target, geometry.start(branch));
}

/// Computes the foot's centre in the leg frame, m.
[[nodiscard]] Vector3 forward_least_squares(const LeastSquaresLegGeometry& geometry,
                                            const LegJointAngles& q) noexcept;

/// Computes d foot / d servo, m/rad, rows x, y, z of the leg frame: axis x (foot - joint), and of what
/// follows it as many times as it turns. The last column of a leg of two servos is zero.
Matrix3 least_squares_jacobian(const LeastSquaresLegGeometry& geometry, const LegJointAngles& q) noexcept;

/// Returns margins, of which `serial` is the bend of the knee from straight or folded, seen along its axis:
/// between the hip's and the foot's directions from it (of a leg with an ankle the ankle's). `parallel` is
/// pi/2: there is no such singularity.
LegMargins least_squares_margins(const LeastSquaresLegGeometry& geometry, const LegJointAngles& q) noexcept;

/// Returns the angle from thigh to shin about the knee's axis, counted from where +y lies on it: positive if
/// the knee is bent forward. In (-pi, pi], rad.
double knee_bend(const LeastSquaresLegGeometry& geometry, const LegJointAngles& q) noexcept;

}  // namespace crossgait
