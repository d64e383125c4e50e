// The engine-free description of a robot: the single source from which every engine's model is built.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "physics/core/math.h"
#include "physics/robot/contact_settings.h"
#include "physics/robot/leg.h"

namespace crossgait {

/// Holds mass properties of one body, in the body's frame.
struct SpatialInertia {
  double mass = 0;                 ///< kg
  Vector3 p_BC = Vector3::Zero();  ///< centre of mass, m
  Matrix3 I_C = Matrix3::Zero();   ///< inertia about the centre of mass, body axes, kg m^2
};

enum class ShapeType { kSphere, kBox, kCylinder, kCapsule, kHull };

/// Names a shape's type in documents and in Python.
constexpr std::string_view name(ShapeType type) {
  constexpr std::array<std::string_view, 5> kNames{"sphere", "box", "cylinder", "capsule", "hull"};
  return kNames.at(static_cast<std::size_t>(type));
}

/// Most vertices of a hull. MuJoCo takes 50 contacts of two geoms.
inline constexpr int kMaxHullVertices = 32;

/// Describes a collision shape, rigidly attached to a body. Shapes of one robot never collide with each
/// other, only with terrain, which they touch in the same places on every engine (contact_features.h).
struct CollisionShape {
  std::string name;
  ShapeType type = ShapeType::kSphere;
  Vector3 size = Vector3::Zero();  ///< sphere: (radius, 0, 0); box: half extents; cylinder: (radius, half
                                   ///< length, 0), axis z; capsule: the same, half length between the centres
                                   ///< of its ends; hull: not used
  Pose X_BG = Pose::Identity();    ///< pose of the shape in the body frame
  std::vector<Vector3> vertices;   ///< of a hull, in the shape's frame, m: 4 to kMaxHullVertices
};

enum class VisualType { kSphere, kBox, kCylinder, kCapsule, kMesh };

/// Names a shape's type in documents and in Python.
constexpr std::string_view name(VisualType type) {
  constexpr std::array<std::string_view, 5> kNames{"sphere", "box", "cylinder", "capsule", "mesh"};
  return kNames.at(static_cast<std::size_t>(type));
}

/// Describes what a body looks like. No engine sees it.
struct VisualShape {
  VisualType type = VisualType::kSphere;
  Vector3 size = Vector3::Zero();  ///< as CollisionShape's; capsule: (radius, half length between the centres
                                   ///< of its ends, 0), axis z; of a mesh: not used
  std::string mesh;                ///< its file; empty if there is none: collision shapes stand in for it
  Vector3 scale = Vector3::Ones();      ///< metres per unit of the mesh, along its axes
  Pose X_BG = Pose::Identity();         ///< pose of the shape in the body frame
  std::optional<Eigen::Vector4d> rgba;  ///< 0..1, if stated
};

/// Describes the revolute joint that connects a body to its parent, and its drive.
struct Joint {
  std::string name;
  Vector3 axis = Vector3::UnitZ();  ///< unit axis in the body frame (equal to the joint frame); right-handed
  double lower = -3.14159265358979323846;  ///< rad; these limits bound commanded targets, and the angle
  double upper = 3.14159265358979323846;   ///< rad  where the joint is `limited`
  /// Engines keep the angle within the limits, each by its law (Laws::joint_limits).
  bool limited = false;
  Softness limit_softness;  ///< of that law where it is soft; violations are in rad. MuJoCo's defaults
  double damping = 0;       ///< viscous, N m s/rad
  /// Share of it that acts on the speed at which a step ends rather than begins, 0 to 1 (step_armature).
  double implicit_joint_damping = 0;
  double stiffness = 0;         ///< of a spring beside the servo, N m/rad; explicit on every engine
  double spring_reference = 0;  ///< angle at which that spring is at rest, rad
  double friction = 0;          ///< dry (Coulomb), N m; a law of the engine's (docs/conventions.md)
  double armature = 0;          ///< rotor inertia reflected to the joint, kg m^2
  bool actuated = false;
  double kp = 0;  ///< servo stiffness, N m/rad
  double kd = 0;  ///< servo damping, N m s/rad, inside the effort clamp
  /// Shares of the servo's spring and damper that act on the angle and speed at which a step ends rather than
  /// begins, 0 to 1 (actuator.h). ServoLaw names the pairs that simulators have.
  double implicit_stiffness = 0, implicit_damping = 0;
  double effort_limit = 0;     ///< N m; 0: not given, which only a joint that is not actuated may have
  double effort_negative = 0;  ///< the same in the direction of negative torque, N m; 0: as effort_limit
  double target_lower = -1e6;  ///< targets are clipped to these, and to the limits above, rad: the range
  double target_upper = 1e6;   ///< of a servo's control; far beyond any limit unless a file says one

  // What a real drive falls short of by (actuator.h, drives.h). All off by default.
  double corner_speed = 0;   ///< up to which there is all the effort, rad/s
  double no_load_speed = 0;  ///< at which there is none left, rad/s; 0: there is at any speed
  double backlash = 0;       ///< play between motor and joint, from stop to stop, rad
  double delay = 0;          ///< from a target to its torque, s; whole physics steps
  double lag = 0;            ///< time constant with which what the servo holds follows the target, s
  double sensor_noise = 0;   ///< of the angle that the servo measures, uniform in +- this, rad
};

/// Describes one rigid body. Body 0 is the base; body i + 1 hangs on joint i.
struct Body {
  std::string name;
  int parent = -1;               ///< index of the parent body, smaller than its own; -1 for the base
  Pose X_PB = Pose::Identity();  ///< pose in the parent body at zero joint angle: the joint's frame
  Joint joint;                   ///< unused for the base
  SpatialInertia inertia;
  std::vector<CollisionShape> shapes;
  std::vector<VisualShape> visuals;
};

/// Holds two points of two bodies together by a soft ball joint (closes a kinematic loop).
struct LoopClosure {
  std::string name;
  int body_a = 0, body_b = 0;
  Vector3 p_AP = Vector3::Zero(), p_BP = Vector3::Zero();  ///< the point in either body's frame, m
};

/// Holds one joint by a soft row to where a polynomial of another joint's angle has it: a gear, a belt, a
/// parallel linkage whose bars are left out.
struct JointCoupling {
  int follower = -1, leader = -1;  ///< indices of joints
  /// Of the follower's angle (rad) in powers of the leader's, from the constant up.
  std::array<double, 5> coefficients{0, 1, 0, 0, 0};
  Softness softness{0.005, 1.0, 0.95, 0.99, 0.001};  ///< violations are in rad; as loops are unless files say

  /// Returns where the follower belongs with its leader at `angle`, rad.
  double follower_at(double angle) const noexcept;
  /// Returns how far it moves per radian of the leader there.
  double slope_at(double angle) const noexcept;
  bool is_linear() const noexcept;
};

/// Says how the joints of a leg are arranged.
enum class LegLinkage {
  kFiveBar,   ///< two chains of shoulder and elbow, on a tilt joint or on the base, joined at the foot by a
              ///< loop
  kSerial,    ///< hip and knee, on an abduction joint or on the base
  kHipFirst,  ///< hip, abduction, knee: the abduction turns with the hip
  kKneeFollows,  ///< abduction and hip, and a knee that is coupled to one of them
  kClosedChain,  ///< hip, knee and what else is between base and foot, some of them moved by bars beside them
                 ///< that loops join to the leg
};

/// Says what a joint of a closed chain is: one between base and foot, or of a bar beside these.
enum class LegPart { kAbduction, kHip, kKnee, kAnkle, kBar };
/// Names a part between base and foot as its role is called.
std::string_view name(LegPart part) noexcept;

/// Describes a joint of a leg: what it is called, and the role (its index) that it hangs on; -1: on the base.
struct LegRole {
  static constexpr int kAnyParent = -2;  ///< on the base, or on any of the leg
  std::string_view name;
  int parent;
  bool actuated;
};

inline constexpr std::size_t kMaxLegJoints = 10;

/// Lists the roles of a leg, in place.
class LegRoles {
 public:
  LegRoles() = default;
  explicit LegRoles(std::span<const LegRole> roles) noexcept {
    for (const LegRole& role : roles) push_back(role);
  }
  void push_back(const LegRole& role) noexcept { roles_[size_++] = role; }
  std::size_t size() const noexcept { return size_; }
  const LegRole& operator[](std::size_t i) const noexcept { return roles_[i]; }
  const LegRole* begin() const noexcept { return roles_.data(); }
  const LegRole* end() const noexcept { return roles_.data() + size_; }

 private:
  std::array<LegRole, kMaxLegJoints> roles_{};
  std::size_t size_ = 0;
};

/// Describes one leg: its joints (indices into joint vectors) in the order of its roles, and its foot.
struct LegModel {
  LegLinkage linkage = LegLinkage::kFiveBar;
  std::vector<int> servos;     ///< tilt (if any), shoulder_left, shoulder_right; or abduction (if any), hip,
                               ///< knee; or hip, abduction, knee; or abduction, hip
  std::vector<int> passive;    ///< elbow_left, elbow_right; or the knee that follows, and the ankle that
                               ///< does, of which a leg has both, one or none
  std::vector<LegPart> parts;  ///< of a closed chain what servos, then passive joints are; else empty
  int foot_body = -1;          ///< index of the body that carries the foot
  Vector3 p_BF = Vector3::Zero();  ///< foot centre in that body's frame, m
  double foot_radius = 0;          ///< m

  /// Lists the roles of servos, then of passive joints. Bars of a closed chain are called "crank" (one with a
  /// servo) and "rod", further ones "crank_2", "rod_2" and so on.
  LegRoles roles() const noexcept;
  /// Lists servos, then passive joints: as `roles`.
  std::vector<int> joints() const;
  /// Returns the place of the role of this name among `roles` and `joints`, or -1.
  int place(std::string_view role) const noexcept;
  /// Returns the joint in the role of this name, or -1.
  int joint(std::string_view role) const noexcept;
  /// Returns the joint of a leg with a knee that moves the link at its end: the ankle, or without one the
  /// knee.
  int last_joint() const noexcept;
};

/// Holds everything the engines need to know of a robot.
struct RobotDescription {
  std::string name;
  std::string source;        ///< file it came from, for messages
  std::vector<Body> bodies;  ///< topological order, base first
  std::vector<LoopClosure> loops;
  std::vector<JointCoupling> couplings;  ///< at most one for each follower, and none in a circle
  ContactSettings contact;               ///< what its files ask of contacts; a world may say otherwise
  Softness loop_softness{0.005, 1.0, 0.95, 0.99, 0.001};
  /// Softens dry friction in joints, which engines with hard joint friction ignore; nothing is ever violated,
  /// so damping ratio and width do not count. Stiffer than MuJoCo's defaults, with which friction pushes a
  /// joint on that stops by itself, and stuck joints creep eight times as fast (docs/conventions.md).
  Softness friction_softness{0.005, 1.0, 0.95, 0.99, 0.001};
  std::optional<LegArray<LegModel>> legs;  ///< absent only for test bodies built in code
  JointVector home;        ///< joint angles of the home pose, loops closed and followers where
                           ///< they belong, rad
  double home_height = 0;  ///< height of the base origin over flat ground in the home pose, m
  /// h, m: how deep below hips or shoulders the feet of a standing leg are; gaits, ranges and limits are
  /// multiples of it and of sqrt(h / g) (gait/scale.h).
  double standing_height = 0;
  double stance_offset = 0;  ///< forward shift of the feet that brings them under the centre of mass, m

  int joint_count() const { return static_cast<int>(bodies.size()) - 1; }
  const Joint& joint(int i) const { return bodies[static_cast<std::size_t>(i) + 1].joint; }
  /// Lists joint indices in the order of `JointTargets`.
  std::vector<int> actuated_joints() const;
  double total_mass() const;  ///< kg
  /// Tells whether any joint has dry friction.
  bool has_joint_friction() const noexcept;
  /// Tells whether any joint is limited.
  bool has_joint_limits() const noexcept;
  /// Finds the coupling of which a joint is the follower, or null.
  const JointCoupling* coupling_of(int follower) const noexcept;
  /// Puts every follower without a servo where its leader's angle has it, along chains of them.
  /// @param q  joint angles, rad
  void place_followers(JointVector& q) const noexcept;

  /// Checks every invariant stated above (finite, positive masses, physical inertias, tree order, loops
  /// closed and couplings kept at home, unique names). @throws ConfigError naming `source` and the element.
  void validate() const;
};

/// Returns the index of the leg of whose foot the shape `shape` of body `body` is, or -1: the sphere at the
/// foot's centre, and others that are at least 0.85 as far as it is from the axis of the body's joint.
int leg_of_shape(const RobotDescription& robot, int body, int shape) noexcept;

/// Reads `robot.yaml` (which names its URDF, MJCF or SDF), or a bare file of these (robot_formats.h) with,
/// if there is one, a `.yaml` of the same stem or `robot.yaml` beside it. What the files do not say is
/// inferred (robot_inference.h, `load_robot_with_report`).
/// @throws ConfigError naming file and element.
RobotDescription load_robot(const std::string& path);

}  // namespace crossgait
