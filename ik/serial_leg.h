// Kinematics in closed form of a serial leg: hip and knee about y, on an abduction joint about x or on the
// base. The plane of the leg, its tilt (here the abduction) and the two links in it are those of
// ik/tilt_mount.h and ik/two_link_chain.h, hip and knee being shoulder and elbow.
#pragma once

#include <array>

#include "ik/tilt_mount.h"
#include "physics/robot/leg.h"
#include "physics/robot/robot.h"

namespace crossgait {

/// Says where a leg with its foot below the hip has its knee: towards +x or -x of the line from hip to foot.
/// The angle from thigh to shin, in the leg's plane, is positive or negative.
enum class KneeBranch { kForward = 1, kBackward = -1 };

constexpr double knee_sign(KneeBranch branch) { return branch == KneeBranch::kForward ? 1.0 : -1.0; }

/// Says which joints of a robot make a serial leg (indices into joint vectors), and where its foot is.
struct SerialLegJoints {
  int abduction = -1;  ///< -1: none, the hip is on the base
  int hip = -1, knee = -1;
  int foot_body = -1;              ///< index of the body that carries the foot: the ankle's, else the knee's
  Vector3 p_BF = Vector3::Zero();  ///< foot centre in that body's frame, m
  bool hip_first = false;          ///< the abduction is between hip and knee
  int ankle = -1;                  ///< one that follows another joint of the leg; -1: none
  bool knee_follows = false;       ///< the knee has no servo and follows another joint of the leg
};

/// Holds the joints in a row from the base, two to four of them, which of these is the hip, and how many have
/// a servo: the first ones.
struct SerialChain {
  std::array<int, 4> joints{-1, -1, -1, -1};
  int count = 0, hip = 0, servos = 0;
};
SerialChain chain_of(const SerialLegJoints& joints);

/// Returns the joints of a leg that is serial.
SerialLegJoints serial_leg_joints(const LegModel& model);

/// @throws ConfigError naming file, leg and joint unless the joints are `robot`'s, hang on each other in
/// their
///   row, the first on the base, and the foot is on the last one's body
void validate(const RobotDescription& robot, Leg leg, const SerialLegJoints& joints);

/// Describes a serial leg; without an abduction joint its plane is y = 0 of the leg frame, and nothing but
/// p_BL and `side` is used of the mount.
struct SerialLegGeometry : TiltMount {
  bool has_abduction = true;
  TwoLinkChain chain;  ///< hip, thigh, knee, shin; shoulder_x is 0
};

/// Tells whether the axes of the joints are those of a serial leg, each within `tolerance` (rad): abduction
/// along +-x, hip and knee along +-y of the base, at zero angles, the abduction first and no joint that
/// follows. @throws ConfigError if they do not hang on each other
bool is_serial_leg(const RobotDescription& robot, Leg leg, const SerialLegJoints& joints,
                   double tolerance = kAxisAlignment);

/// Derives the geometry of one leg from the joint frames of `robot`, which may be turned anyhow at zero
/// angles.
/// @throws ConfigError naming file, leg and joint if the joints do not hang on each other or on the base,
///   their axes are none of a serial leg (`is_serial_leg`), or thigh or shin have no length
SerialLegGeometry serial_leg_geometry(const RobotDescription& robot, Leg leg, const SerialLegJoints& joints,
                                      double tolerance = kAxisAlignment);

/// Holds joint angles in the robot's sign convention, rad; `abduction` is 0 without such a joint.
struct SerialAngles {
  double abduction = 0, hip = 0, knee = 0;
};

struct SerialSolution {
  IkStatus status = IkStatus::kOk;
  SerialAngles angles;
};

/// Finds joint angles that put the foot's centre on `target`, or on the nearest point that the links reach in
/// the leg's plane. That plane goes through the target, and what counts is the foot below the abduction axis,
/// D >= 0: a target nearer to the axis than the plane is too near. Without abduction a target off the plane
/// by more than 1e-9 m (to which kinematics and engines agree) is too far. Angles are whole turns away from
/// what atan2 gives where that brings them inside their limits, and then clamped one by one.
///
/// Never NaN. The foot is continuous in the target except where the nearest point is not unique: at the hip
/// axis (straight down is taken) and on the abduction axis; and while no joint limit is passed on the far
/// side, where the two limits are equally near.
/// @param target  foot centre in the leg frame (x forward, y left, z up: negative below the hip), m
[[nodiscard]] SerialSolution solve_serial(const SerialLegGeometry& geometry, const Vector3& target,
                                          KneeBranch branch) noexcept;

/// Computes the foot's centre in the leg frame, m.
[[nodiscard]] Vector3 forward_serial(const SerialLegGeometry& geometry, const SerialAngles& q) noexcept;

/// Computes d foot / d (abduction, hip, knee), m/rad, rows x, y, z of the leg frame. The first column is zero
/// without abduction.
Matrix3 serial_jacobian(const SerialLegGeometry& geometry, const SerialAngles& q) noexcept;

/// Returns the margins, `joint_limit` that of the leg's joints; `serial` is the smaller of the knee's bend
/// from straight or folded and the angle whose tangent is D over the leg's length: at D = 0 the abduction
/// cannot move the foot out of what hip and knee do. A serial leg has no parallel singularity: pi/2.
LegMargins serial_margins(const SerialLegGeometry& geometry, const SerialAngles& q) noexcept;

/// Returns the angle from thigh to shin in the leg's plane, in (-pi, pi], rad: zero if the knee is straight.
double knee_bend(const SerialLegGeometry& geometry, double knee) noexcept;

}  // namespace crossgait
