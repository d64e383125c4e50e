// The one virtual interface: a robot on a terrain in some physics engine.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "physics/engine/world_spec.h"
#include "physics/robot/drives.h"
#include "physics/robot/state.h"

namespace crossgait {

/// Says which numbers an engine keeps its state in and steps with.
enum class Precision { kFloat64, kFloat32 };

/// Returns the distance from 1 to the next number: what bounds of rounding are multiples of.
constexpr double epsilon(Precision precision) noexcept {
  return precision == Precision::kFloat32 ? std::numeric_limits<float>::epsilon()
                                          : std::numeric_limits<double>::epsilon();
}
/// Names a precision: "float64", "float32".
constexpr std::string_view name_of(Precision precision) noexcept {
  return precision == Precision::kFloat32 ? "float32" : "float64";
}

/// Says what an engine and mode declares; tests skip on these and on nothing else.
struct Capabilities {
  bool soft_contact = false;      ///< honours ContactSpec::softness
  bool soft_friction = false;     ///< honours ContactSpec::impratio
  bool turning_friction = false;  ///< honours ContactSpec::condim, torsional and rolling friction
  bool pyramidal_cone = false;    ///< honours ContactSpec::cone
  bool error_reduction = false;   ///< honours ContactSpec::erp, max_depenetration_velocity and cfm
  bool sweeps = false;            ///< SolverSpec::iterations bounds what it finds, not only its effort
  bool exact_field_query =
      false;  ///< terrain_height is exact to rounding (1e-12 m) rather than to the ray test (2e-6 m)
  bool allocates = false;  ///< the engine's own library allocates in a step
  Precision precision = Precision::kFloat64;

  bool operator==(const Capabilities&) const = default;
};

/// Names the laws that an engine solves. Engines that agree in all of them solve the same equations, so that
/// nothing but rounding may lie between them: they are held to the tight tolerances. Behind a slash stands
/// how an engine departs from the law by the way in which it solves it: "hard/sweeps".
struct Laws {
  std::string contact;         ///< normal force and friction between robot and terrain: "mujoco", "hard"
  std::string loops;           ///< of loop closures: "mujoco" (soft, with its reference acceleration)
  std::string joint_friction;  ///< dry friction in joints: "mujoco" (soft), "hard"; "" for none
  std::string joint_limits;    ///< of joints that are limited: "mujoco" (soft), "hard"; "" for none
  std::string couplings;       ///< of coupled joints: "mujoco" (soft); "" for none: refuses robots with them
  /// Of servos whose torque hangs on how a step ends (implicit_servo.h): "implicit"; "" for none: refuses
  /// robots with them.
  std::string implicit_servos = {};
  /// What the law of contact is a relative of: "compliant" (forces from penetration) or "rigid" (impulses
  /// that end it). Relatives count as one opinion where they agree.
  std::string contact_family;

  /// Returns the law of contact without the way it is solved: two engines of one are no two opinions of it.
  std::string_view contact_law() const noexcept {
    return std::string_view(contact).substr(0, contact.find('/'));
  }

  bool operator==(const Laws&) const = default;
};

struct EngineInfo {
  std::string name;     ///< the name it is chosen by: "mujoco", "bullet", "bullet:matched"
  std::string library;  ///< "MuJoCo", "Bullet"
  std::string version;  ///< of the engine's library, e.g. "2.2.2"
  std::string mode;     ///< contact mode in words
  Laws laws;
  Capabilities capabilities;
  /// Which of Crossgait's own code it runs on, beside what every engine does: "contact solver".
  std::vector<std::string> own_parts;

  bool operator==(const EngineInfo&) const = default;
};

/// Returns the epsilon of the one of two engines that keeps less.
inline double coarser_epsilon(const EngineInfo& a, const EngineInfo& b) noexcept {
  return std::max(epsilon(a.capabilities.precision), epsilon(b.capabilities.precision));
}

/// Names those settings of `contact` that are not as by default and make no difference under the laws of an
/// engine with these capabilities: "impratio". Friction is of every law.
std::vector<std::string> not_of_law(const ContactSpec& contact, const Capabilities& capabilities);

/// Lists Crossgait's own code that both run on: what they agree in for that reason is no evidence.
std::vector<std::string> shared_parts(const EngineInfo& a, const EngineInfo& b);

/// Holds a saved instant. Restoring it, in this or in another world built from the same WorldSpec, continues
/// bit for bit.
struct Snapshot {
  std::string engine_name;  ///< EngineInfo::name it came from
  RobotState state;
  ContactList contacts;
  JointVector torques, servo_torques;
  Vector3 push = Vector3::Zero();
  bool diverged = false;
  std::vector<double> drives;  ///< targets that are on their way
  std::vector<double> engine;  ///< the engine's own configuration, bit for bit
  std::vector<BodyWrench> wrenches = {};
};

/// How many wrenches may act on a robot at once.
inline constexpr std::size_t kMaxWrenches = 64;

/// Holds angles within which joints are kept, by joint, rad.
struct JointRanges {
  /// Makes a range without bounds for every joint.
  explicit JointRanges(int joints)
      : lower(JointVector::Constant(joints, -std::numeric_limits<double>::infinity())), upper(-lower) {}

  JointVector lower, upper;
};
/// Returns the ranges that a robot's description asks for.
JointRanges joint_limits(const RobotDescription& robot);

/// Runs one world on one thread. Two instances may run on two threads.
///
/// Public functions validate and share what engines must not differ in (the servo law, divergence checks);
/// engines implement the private virtual ones. See `docs/conventions.md` for frames.
class PhysicsBackend {
 public:
  virtual ~PhysicsBackend() = default;
  PhysicsBackend(const PhysicsBackend&) = delete;
  PhysicsBackend& operator=(const PhysicsBackend&) = delete;

  virtual const EngineInfo& info() const = 0;
  const WorldSpec& spec() const { return spec_; }
  const RobotDescription& robot() const { return *spec_.robot; }

  /// Puts the robot into `state` (time included) and forgets contacts, pending pushes and wrenches.
  /// @throws ConfigError if sizes differ from the robot's or a value is not finite or the quaternion is not
  /// unit, or if the robot has coupled joints and the engine no law of them, or implicit servos and the
  /// engine does not solve them
  void reset(const RobotState& state);
  /// Resets to `home_state()`.
  void reset() { reset(home_state()); }
  /// Returns the home pose at rest over the world origin, at home_height above the terrain's highest point
  /// under the robot.
  RobotState home_state() const;

  /// Advances `substeps` physics steps holding `targets`; torques are recomputed every physics step:
  /// tau = clamp(kp (q* - q) - kd qd, +-effort_limit) on servos (with what their drives fall short of:
  /// drives.h; of implicit ones q and qd are those at the step's end: actuator.h), then - damping qd -
  /// stiffness (q - spring_reference) on every joint.
  /// Targets are clamped to the joints' limits; where a joint is `limited` its angle is kept within them, by
  /// the engine's law. Targets of the wrong size or not finite change nothing and
  /// return kInvalidTargets. After kDiverged the state keeps its last good value and every further step
  /// returns kDiverged until reset or restore.
  [[nodiscard]] StepStatus step(const JointTargets& targets, int substeps = 1) noexcept;

  const RobotState& state() const noexcept { return state_; }
  /// Returns contacts of the last physics step, at the configuration it began with. Empty after reset.
  const ContactList& contacts() const noexcept { return contacts_; }
  LegArray<FootContact> foot_contacts() const noexcept;
  /// Returns torques applied in the last physics step, N m: servo, damper and spring of each joint.
  const JointVector& torques() const noexcept { return torques_; }
  /// Returns what servos applied of them, N m.
  const JointVector& servo_torques() const noexcept { return servo_torques_; }

  /// Returns the height of the terrain under (x, y), asked of the engine's own geometry by a ray, m. NaN
  /// where there is none.
  double terrain_height(double x, double y) const { return do_terrain_height(x, y); }
  /// Returns the pose of a body in W as the engine has it now. `body` indexes RobotDescription::bodies.
  Pose body_pose(int body) const;
  /// Returns the joint-space inertia that a step has, of engine bodies plus step_armature (actuator.h); rows
  /// and columns [v_WB, w_WB, qd] (6 + joints), or the joints alone for a fixed base. kg, kg m, kg m^2.
  Eigen::MatrixXd mass_matrix() const { return do_mass_matrix(); }
  /// Returns mass properties as the engine holds them, in the frame of RobotDescription.
  SpatialInertia body_inertia(int body) const;
  /// Returns the dry friction of every joint as the engine holds it, N m; zero where it simulates none.
  JointVector joint_friction() const { return do_joint_friction(); }
  /// Returns the angles that each joint is kept within as the engine holds them, rad; infinite if none.
  JointRanges joint_limits() const { return do_joint_limits(); }

  /// Adds an impulse (N s, in W) at the base's centre of mass, spread over the next physics step.
  /// @throws ConfigError if not finite
  void apply_push(const Vector3& impulse);

  /// Lets a wrench act on a body in every physics step until `clear_wrenches` or a reset, beside those that
  /// do. Engines get its generalised forces (J^T of `point_jacobian`) at the configuration that a step begins
  /// with. @throws ConfigError if it is not finite, there is no such body, or kMaxWrenches act
  void apply_wrench(const BodyWrench& wrench);
  void clear_wrenches() noexcept { wrenches_.clear(); }

  Snapshot save() const;
  /// @throws ConfigError if the snapshot is of another engine or robot
  void restore(const Snapshot& snapshot);

 protected:
  /// @throws ConfigError if the specification is invalid
  explicit PhysicsBackend(WorldSpec spec);

  /// Lists the servos that an engine solves in `do_step`, beside the torques that it is given: those of
  /// implicit laws. Empty for engines without Laws::implicit_servos.
  std::span<const ImplicitServo> implicit_servos() const noexcept { return drives_.implicit(); }

 private:
  virtual void do_reset(const RobotState& state) = 0;
  /// Makes one physics step under joint torques `tau` and a wrench on the base, its force at the base's
  /// centre of mass; a fixed base does not feel it. kDiverged where the engine itself noticed; the caller
  /// checks the state it reads back besides.
  virtual StepStatus do_step(const JointVector& tau, const Wrench& base) noexcept = 0;
  virtual void do_read_state(RobotState& state) const noexcept = 0;
  virtual void do_read_contacts(ContactList& contacts) const noexcept = 0;
  virtual double do_terrain_height(double x, double y) const = 0;
  virtual Pose do_body_pose(int body) const = 0;
  virtual Eigen::MatrixXd do_mass_matrix() const = 0;
  virtual SpatialInertia do_body_inertia(int body) const = 0;
  virtual void do_save(std::vector<double>& engine) const = 0;
  virtual void do_restore(const std::vector<double>& engine) = 0;
  virtual JointVector do_joint_friction() const { return JointVector::Zero(robot().joint_count()); }
  virtual JointRanges do_joint_limits() const { return JointRanges(robot().joint_count()); }

  void refuse_robot() const;
  void compute_torques(const JointTargets& targets) noexcept;
  void add_implicit_torques() noexcept;
  void add_wrenches(JointVector& tau, Wrench& base) noexcept;
  [[nodiscard]] StepStatus advance(const JointTargets& targets) noexcept;

  WorldSpec spec_;
  std::vector<int> actuated_;
  Drives drives_;
  RobotState state_;
  ContactList contacts_;
  JointVector torques_, servo_torques_;
  RobotState next_;                 ///< read back here, so that a diverged state never replaces a good one
  Vector3 push_ = Vector3::Zero();  ///< N s, pending
  std::vector<BodyWrench> wrenches_;
  std::vector<Pose> poses_;  ///< of the bodies, where a wrench acts
  bool diverged_ = false;
};

}  // namespace crossgait
