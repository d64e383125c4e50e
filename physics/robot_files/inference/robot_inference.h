// What a robot's file does not say and its shape does: legs, frame, feet, home pose and servos.
// The rules were tried on two dozen real quadrupeds; docs/robots.md has them, docs/robots-measured.md what
// came of each.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "physics/robot_files/parsed_robot.h"

namespace crossgait {

/// Describes one thing that was inferred, for people to check.
struct Inference {
  std::string what, value, reason;
};

/// Describes the wheel at the end of a leg, which is held.
struct HeldWheel {
  std::string joint, link;
  Vector3 centre = Vector3::Zero();  ///< in the link's frame, m
  double radius = 0;                 ///< m
};

/// Names the joints of a leg.
struct FoundChain {
  LegLinkage linkage = LegLinkage::kSerial;
  std::vector<std::string> joints;     ///< those with a role, servos from the base outwards, then followers
  std::size_t followers = 0;           ///< how many of them follow: a knee, an ankle; a five-bar's elbows
  std::vector<LegPart> parts;          ///< of a closed chain, what each of them is
  std::map<std::string, double> held;  ///< the others, and at which angle, rad
  std::optional<HeldWheel> wheel;
};

struct LegSearch {
  LegArray<FoundChain> legs;
  /// Every moving joint of no leg that follows none that moves, and at which angle it is held, rad.
  std::map<std::string, double> locked;
  /// Columns: forward, left and up of the robot in the file's base frame.
  Matrix3 R_BA = Matrix3::Identity();
};

/// Finds the legs: the four branches of the base that are alike: as many moving joints, in one chain each,
/// their axes at the same angles to each other; or four such chains on two bodies, with a spine between them.
/// Roles follow from axes (leg_roles.h), which leg is which from where they are and what they are called
/// (leg_frame.h). @param frame  forward, left and up if they are known
/// @throws ConfigError (naming `source`) that says what was found instead: no four such branches; eight
///   chains of two joints, of which five-bars are made that only `loops` can say; legs of too many joints, or
///   without two parallel ones; legs that branch; two in one quadrant
LegSearch find_legs(const ParsedRobot& robot, const std::string& source, const std::optional<Matrix3>& frame,
                    std::vector<Inference>& inferred, std::vector<std::string>& warnings);

/// Returns where a joint is held that is no servo: at the home pose of the file if that has one, else at
/// zero; within its limits, rad.
double held_angle(const ParsedRobot& robot, const Joint& joint);

/// Describes a foot on the last link of a leg.
struct FootPlace {
  Vector3 p_BF = Vector3::Zero();  ///< centre in the body's frame, m
  double radius = 0;               ///< m
  int shape = -1;                  ///< the (first) collision sphere that it is, or -1: there is none yet
  std::string reason;
};

/// Finds the collision sphere farthest from the axis of the body's joint, or the middle of several as large
/// that are as far: toes; without one, the end of a capsule
/// that is, or a cylinder across the leg; without these, a small sphere at the farthest point of its shapes.
/// Nothing without shapes.
std::optional<FootPlace> find_foot(const ParsedRobot& robot, const Body& body);
/// Finds a foot likewise by what the body looks like.
std::optional<FootPlace> find_seen_foot(const Body& body);
/// Finds the origin of the link fixed to a body that is farthest from its joint's axis, and a small radius.
std::optional<FootPlace> find_foot_link(const ParsedRobot& robot, int body);

/// Removes from a foot's body what would touch the ground along with the foot: meshes, and what lies within a
/// radius around it. @param urdf  knows which shapes are meshes  @returns how many
std::size_t leave_out_around(const ParsedRobot& urdf, const Vector3& p_BF, double radius, Body& body);

/// Holds lengths of a serial leg and its share of them that it stands at.
struct LegLengths {
  double thigh = 0, shin = 0;  ///< m, across the hip's axis
  double sum() const { return thigh + shin; }
};
LegLengths leg_lengths(const RobotDescription& robot, Leg leg);

inline constexpr double kStandingShare = 0.72;  ///< of thigh and shin: depth of a standing foot below the hip

/// Holds angles of the servos with the foot at depth `height` (m) below the hip and all feet so far forward
/// that their middle lies under the robot's centre of mass (at most 0.15 of the leg's length), and how far
/// that is. Knees: the branch that lies inside the limits, backward if both do. Angles that stand already in
/// `robot.home` are not used. Requires serial legs. @throws ConfigError if neither branch fits
struct HomePose {
  JointVector q;
  double forward = 0;  ///< of the feet, from below the hips, m
};
HomePose find_home(const RobotDescription& robot, double height, std::vector<Inference>& inferred);

/// Returns the mean length of upper and lower links over a five-bar's chains, m. Requires its loop.
double five_bar_length(const RobotDescription& robot, Leg leg);
/// Puts the feet of five-bars at depth `height` (m) below the middle of their shoulders, elbows outward and
/// tilts at zero. @throws ConfigError where a link is too short or a limit forbids it
JointVector find_five_bar_home(const RobotDescription& robot, double height,
                               std::vector<Inference>& inferred);

/// Says why serial legs cannot stand at these angles: beyond limits, feet not below their hips by a third of
/// the leg or more, or not at one depth to a third of it. Empty if they can.
std::string problem_with_stance(const RobotDescription& robot, const JointVector& q);
/// Returns how far ahead of the hips the feet have to stand to be under the robot's centre of mass, at most
/// 0.15 of the leg's length, m. Requires serial legs.
double balanced_offset(const RobotDescription& robot, const JointVector& q);
inline constexpr const char* kStanceOffsetReason =
    "the middle of the feet under the centre of mass of the robot, at most 0.15 of thigh and shin";

/// Estimates servo gains, rotor inertia and torque limit of joints whose file gives none, from mass (kg),
/// standing height h and leg length (m).
struct ServoRule {
  double kp = 0, kd = 0, armature = 0;  ///< N m/rad, N m s/rad, kg m^2
  double effort_limit = 0;              ///< N m, of a joint whose file has none, or no real one:
  double largest_real_effort = 0;       ///< N m
};
ServoRule servo_rule(double mass, double height, double leg_length);

}  // namespace crossgait
