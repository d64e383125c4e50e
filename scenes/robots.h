// Robots for tests and benchmarks of the engines: the ones in models/, and small ones built in code whose
// motion is known in closed form.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "physics/robot/robot.h"

namespace crossgait::scenes {

using RobotPtr = std::shared_ptr<const RobotDescription>;

/// Loads models/robots/scara_quadruped and models/robots/scara_quadruped_long.
RobotPtr quadruped();
RobotPtr long_quadruped();
/// Loads models/robots/serial_quadruped.
RobotPtr serial_quadruped();

/// Makes a quadruped on five-bars without tilts, which swing in one plane each: links of 0.1 and 0.2 m,
/// shoulders `apart` (m) from each other along x, 0: on one axis. It stands 0.22 m high.
RobotPtr planar_five_bars(double apart);

/// Makes a quadruped whose knees are turned by a crank about the hip's axis and a rod: a four-bar of four
/// unequal lengths beside each thigh. It stands 0.2 m high with all angles zero.
RobotPtr four_bar_knees();
/// Makes a quadruped with legs of three links, of which the last is turned by a rod from thigh to toe. It
/// stands likewise.
RobotPtr pantographs();

/// Returns a solid box's mass properties about its own centre, which lies at `p_BC`.
SpatialInertia solid_box(double mass, const Vector3& half_extents, const Vector3& p_BC = Vector3::Zero());

/// Makes one rigid body, 0.7 kg, with three different principal moments about axes of its own and a centre of
/// mass off its origin. No shapes.
RobotPtr tumbling_body();

/// Describes one link of a planar arm: it turns about +y and hangs straight down at zero. Its centre of mass
/// is `length` below its joint, the next link's joint `2 length`.
struct ArmLink {
  double mass = 0.2;      ///< kg
  double length = 0.25;   ///< m
  double inertia = 2e-3;  ///< about the centre of mass and the joint's direction, kg m^2
  double armature = 0;    ///< kg m^2
  double damping = 0;     ///< N m s/rad
  double friction = 0;    ///< dry, N m
  bool servo = false;
  double kp = 0, kd = 0;    ///< N m/rad, N m s/rad
  double effort_limit = 1;  ///< N m
  double limit = 3.1;       ///< targets within +-limit, rad, and the angle where it is limited
  bool limited = false;

  /// Returns the inertia of the link alone, about its joint, with the armature.
  double joint_inertia() const { return inertia + mass * length * length + armature; }
};
/// Makes links in series, the first on a base that is meant to be fixed. No shapes.
RobotPtr arm(const std::vector<ArmLink>& links);

/// Two pendulums side by side on a base that is meant to be fixed, of which the second turns `ratio` times as
/// far as the first. No shapes.
RobotPtr geared_pendulums(const ArmLink& leader, const ArmLink& follower, double ratio);

/// One body of 1 kg on four spheres of radius `kSledRadius` whose centres are at the corners of a rectangle
/// about the origin, where its centre of mass is too: it slides rather than tips.
inline constexpr double kSledRadius = 0.02;
RobotPtr sled();

/// Makes one body of 0.5 kg with one shape centred on the origin: `size` as in CollisionShape.
RobotPtr block(ShapeType type, const Vector3& size);
/// Makes a block whose shape is no more than a type and sizes.
RobotPtr block(CollisionShape shape);
/// Makes a gem: a hull of 12 points, no two at one height in any pose that it rests in, about 0.1 m across.
CollisionShape gem();
/// Makes a trunk with a box, its centre of mass off its origin, that swings a cylinder, a capsule, a hull and
/// a box on servos: it lands on any of them.
RobotPtr assortment();

/// Makes a trunk on servo-driven legs of one link each: 32, as many as a robot may have joints, stand on as
/// many spheres as eight quadrupeds.
/// @param legs  even, up to kMaxJoints
/// @param toes  spheres per leg, side by side
RobotPtr millipede(int legs = kMaxJoints, int toes = 1);

/// Makes a trunk of 30 kg on its belly, which is `points` spheres in two rows, with four legs of one link in
/// the air.
RobotPtr heavy_sledge(int points);

/// Makes a robot of everything at once that a frame or sign error could hide behind elsewhere: a base whose
/// centre of mass is off its origin, full inertia tensors, rotated joint frames, oblique axes, a branch, a
/// loop, unequal drives.
RobotPtr awkward_robot();

/// Validates a robot built in code, after filling in a zero home pose. @throws ConfigError if it is not a
/// valid robot
RobotPtr finished(RobotDescription robot);
/// Returns the robot without loop closures (and so without legs, which require them).
RobotPtr without_loops(const RobotPtr& robot);
/// Returns the robot with this dry friction in every joint, N m.
RobotPtr with_joint_friction(const RobotPtr& robot, double friction);
/// Makes servos implicit, springs and dampers `stiffer` times as stiff (actuator.h).
RobotPtr with_implicit_servos(const RobotPtr& robot, double stiffer = 1);
/// Couples the hip (or left shoulder) of each hind leg of the robot to that of the front leg across from it,
/// with which it moves in a trot.
RobotPtr with_coupled_hips(const RobotPtr& robot);
/// Returns the robot with every joint, and so its targets, kept within `range` rad of its home, either way.
RobotPtr with_joint_limits(const RobotPtr& robot, double range);

}  // namespace crossgait::scenes
