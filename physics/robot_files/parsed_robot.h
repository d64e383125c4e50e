// A robot's file as a tree of moving bodies, and changes of that tree before a robot is made of it.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "physics/robot/robot.h"
#include "physics/robot_files/contact_of_file.h"

namespace crossgait {

/// Says where a link of the file ended up: fixed joints are merged into the moving body they belong to.
struct LinkPlacement {
  int body = 0;                  ///< index into ParsedRobot::bodies
  Pose X_BL = Pose::Identity();  ///< pose of the link's frame in that body
  std::vector<int> shapes;       ///< indices of the link's own shapes in that body
};

/// Names two points of two links that coincide.
struct LinkLoop {
  std::string name, link_a, link_b;
  Vector3 p_a = Vector3::Zero(), p_b = Vector3::Zero();  ///< each in its link's frame, m
};

/// Holds what a file says of a joint or a link that is not simulated.
struct UnusedQuantity {
  std::string of;           ///< the joint, or "link 'shin'"
  std::string name;         ///< as the file has it
  std::string value, unit;  ///< as the file has it; of no unit ""
  std::string why;          ///< it is not
};

/// Describes a joint that follows another one (JointCoupling), by their names.
struct NamedCoupling {
  std::string follower, leader;
  std::array<double, 5> coefficients{0, 1, 0, 0, 0};
  Softness softness = JointCoupling().softness;
  bool says_softness = false;  ///< the file says solref or solimp; else they are what its format has for them
  bool is_driven = false;      ///< the follower has a servo of its own as well
  std::string place;           ///< where the file says it, for messages: "mimic (line 7)"
};

/// Holds what a file says, of whichever format (robot_formats.h); bodies of an MJCF are links here.
struct ParsedRobot {
  std::string name;  ///< of the robot; empty if it has none
  /// Base first, parents before their children, siblings by joint name. A body is named after the link its
  /// joint moves and has that link's frame; joints carry axis, limits, damping and effort limit.
  std::vector<Body> bodies;
  std::map<std::string, LinkPlacement> links;  ///< every link of the file that is simulated
  /// What was left out, taken for something else or repaired: one sentence per kind of thing, counted.
  std::vector<std::string> warnings;
  /// Vertices of collision meshes in the frame of their body, m, by the name of the shape that stands for the
  /// mesh.
  std::map<std::string, std::vector<Vector3>> mesh_vertices;
  // What a URDF cannot say, for one. Likewise kp, kd and armature of joints; 0 is not given.
  std::vector<LinkLoop> loops;
  std::optional<Softness> loop_softness;  ///< of all of them
  std::map<std::string, double> home;     ///< angles by joint, rad; empty if not given
  std::string home_name;                  ///< of the pose, for people
  /// Angles at which the file has its bodies, rad, by joint: of those that are not there zero (MJCF's `ref`).
  std::map<std::string, double> drawn_at;
  /// Where a joint's numbers come from, by joint and number, where the number itself does not say it.
  std::map<std::string, std::map<std::string, std::string>> reasons;
  /// Speeds that the file lets joints have, rad/s, by joint; nothing is simulated by them.
  std::map<std::string, double> velocity_limits;
  std::vector<UnusedQuantity> unused;
  std::vector<NamedCoupling> couplings;
  std::set<std::string> servos;  ///< joints that have one, by the file; empty if it says none
  /// Joints in the order of their actuators, and in that of the file; empty of a file without actuators.
  std::vector<std::string> actuator_order, joint_order;
  std::map<std::string, double> held;  ///< joints that the file itself holds, and at which angle, rad
  /// Joints that something else moves in ways that are not simulated, by joint: "is driven by ...".
  std::map<std::string, std::string> coupled;
  ContactOfFile contact;
};

/// Tells whether a joint of `robot` moves with another one and has no servo of its own.
bool follows(const ParsedRobot& robot, const std::string& joint);

/// Fixes joints: what they move becomes part of what they hang on. @param joints  by name, the angle of each,
/// rad
ParsedRobot lock_joints(ParsedRobot robot, const std::map<std::string, double>& joints);

/// Turns the base's own axes: what was along `R` x of the base is along x afterwards. @param R_BA  rotation
/// whose columns are the new forward, left and up in the file's base frame
ParsedRobot turn_base(ParsedRobot robot, const Matrix3& R_BA);

}  // namespace crossgait
