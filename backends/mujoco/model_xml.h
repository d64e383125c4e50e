// The MuJoCo model of a WorldSpec, as MJCF text.
#pragma once

#include <string>

#include "physics/engine/world_spec.h"

namespace crossgait::mujoco {

/// Names MuJoCo elements made from the description: "body<i>", "joint<i>", "shape<i>_<k>_<part>", "loop<i>",
/// "servo<i>" for the tendon of an implicit servo, "terrain", so that names a user chose need no escaping and
/// cannot clash.
std::string body_name(int body);
std::string joint_name(int joint);
std::string servo_name(int joint);
std::string shape_name(int body, int shape, int part);

/// Returns which of a shape's parts has the contacts of its feature number `feature` (contact_features.h): a
/// shape is as many equal geoms as MuJoCo needs to have room for all of them (kMaxPlaneContacts).
int part_of(const CollisionShape& shape, int feature);

/// Returns the origin of MuJoCo's body in the frame of the description's, m: the centre of mass for the base,
/// zero for the others. MuJoCo integrates the velocity of a free body's origin; were it anywhere else, a
/// freely spinning body would not keep its momentum (0.7 % at 1 ms and 11 rad/s, 6 cm off), and engines that
/// integrate the centre of mass would disagree.
Vector3 body_origin(const RobotDescription& robot, int body);

/// Returns metres per unit of a height field's data: the smallest power of two, so that dividing by it is
/// exact, from 1 on that holds the field's relief. Since 2.3.3 MuJoCo looks for contacts in the box between 0
/// and 1 of the data alone.
double elevation_scale(const HeightField& field);

/// Maps the contact intent to MuJoCo's: solref = (time_constant, damping_ratio), solimp = (impedance_min,
/// impedance_max, impedance_width, impedance_midpoint, impedance_power), of robot and ground alike. Newton's
/// method, Euler integration; damping and servo torques come from outside, so joints carry armature only.
/// Heights of a field are filled in by the caller after compilation (MJCF text cannot hold them).
std::string model_xml(const WorldSpec& spec);

}  // namespace crossgait::mujoco
