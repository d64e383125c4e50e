#include "physics/engine/physics_backend.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/robot/actuator.h"
#include "physics/robot/multibody.h"

namespace crossgait {
namespace {

// Beyond these a legged robot's simulation has exploded, finite or not: speeds of sound, and a joint turning
// faster than any servo by two orders of magnitude.
constexpr double kRunawaySpeed = 340.0;   // m/s
constexpr double kRunawayRate = 1e4;      // rad/s
constexpr double kRunawayAngle = 1e9;     // rad: a day at that rate
constexpr double kRunawayDistance = 1e6;  // m
// So that the first touch-down does not hang on the rounding of a distance of exactly zero.
constexpr double kHomeClearance = 1e-4;  // m

bool is_sane(const RobotState& s) noexcept {
  return s.is_finite() && s.p_WB.lpNorm<Eigen::Infinity>() < kRunawayDistance &&
         s.v_WB.lpNorm<Eigen::Infinity>() < kRunawaySpeed &&
         s.w_WB.lpNorm<Eigen::Infinity>() < kRunawayRate &&
         (s.q.size() == 0 || s.q.lpNorm<Eigen::Infinity>() < kRunawayAngle) &&
         (s.qd.size() == 0 || s.qd.lpNorm<Eigen::Infinity>() < kRunawayRate);
}

/// @throws ConfigError for contacts and wrenches of bodies and legs that there are not: a snapshot may come
/// from a file
void check_indices(const Snapshot& snapshot, const RobotDescription& robot) {
  const auto is_body = [&robot](int body) { return body >= 0 && body <= robot.joint_count(); };
  const auto is_of_it = [&](const Contact& c) { return is_body(c.body) && c.leg >= -1 && c.leg < kLegCount; };
  if (!std::all_of(snapshot.contacts.begin(), snapshot.contacts.end(), is_of_it) ||
      !std::all_of(snapshot.wrenches.begin(), snapshot.wrenches.end(),
                   [&](const BodyWrench& w) { return is_body(w.body); }) ||
      snapshot.wrenches.size() > kMaxWrenches)
    throw ConfigError("restore", "snapshot",
                      fmt::format("contacts of {} bodies and {} legs, and at most {} wrenches on them",
                                  robot.joint_count() + 1, kLegCount, kMaxWrenches),
                      "others");
}

}  // namespace

JointRanges joint_limits(const RobotDescription& robot) {
  JointRanges limits(robot.joint_count());
  for (int i = 0; i < robot.joint_count(); ++i) {
    if (!robot.joint(i).limited) continue;
    limits.lower[i] = robot.joint(i).lower;
    limits.upper[i] = robot.joint(i).upper;
  }
  return limits;
}

std::vector<std::string> not_of_law(const ContactSpec& contact, const Capabilities& capabilities) {
  const bool soft = capabilities.soft_contact || capabilities.soft_friction;
  const std::pair<std::string_view, bool> concerns[] = {
      {"condim", capabilities.turning_friction},
      {"impratio", capabilities.soft_friction},
      {"cone", capabilities.pyramidal_cone},
      {"solref", soft},
      {"solimp", soft},
      {"erp", capabilities.error_reduction},
      {"max_depenetration_velocity", capabilities.error_reduction},
      {"cfm", capabilities.error_reduction},
  };
  std::vector<std::string> names;
  for (const auto& [name, is_of_law] : concerns) {
    const ContactSetting& setting = find_contact_setting(name, "world specification");
    if (!is_of_law && setting.get(contact) != setting.get(ContactSpec())) names.emplace_back(name);
  }
  return names;
}

std::vector<std::string> shared_parts(const EngineInfo& a, const EngineInfo& b) {
  std::vector<std::string> shared{"places, normals and depths of contacts", "shape of the ground",
                                  "servo law and drives", "order of a time step"};
  for (const std::string& part : a.own_parts) {
    if (std::find(b.own_parts.begin(), b.own_parts.end(), part) != b.own_parts.end()) shared.push_back(part);
  }
  return shared;
}

PhysicsBackend::PhysicsBackend(WorldSpec spec) : spec_(std::move(spec)) {
  spec_.validate();
  spec_.group = nullptr;  // whoever makes a world of this specification makes one that is apart
  actuated_ = spec_.robot->actuated_joints();
  drives_ = Drives(*spec_.robot, spec_.physics_dt);
  const int n = spec_.robot->joint_count();
  state_.q = state_.qd = torques_ = servo_torques_ = JointVector::Zero(n);
  next_ = state_;
  wrenches_.reserve(kMaxWrenches);
  poses_.reserve(spec_.robot->bodies.size());
}

RobotState PhysicsBackend::home_state() const {
  const RobotDescription& robot = *spec_.robot;
  RobotState state;
  state.q = robot.home.size() == robot.joint_count() ? robot.home : JointVector::Zero(robot.joint_count());
  state.qd = JointVector::Zero(robot.joint_count());
  // The highest ground within the robot's reach, so that no foot starts inside a bump.
  double ground = spec_.terrain.height(0, 0);
  constexpr double kReach = 0.12;
  for (int i = -4; i <= 4; ++i) {
    for (int j = -4; j <= 4; ++j) {
      ground = std::max(ground, spec_.terrain.height(i * kReach / 4, j * kReach / 4));
    }
  }
  state.p_WB.z() = ground + robot.home_height + kHomeClearance;
  return state;
}

// What the engine does not simulate is not left out in silence.
void PhysicsBackend::refuse_robot() const {
  const std::string& source = robot().source.empty() ? robot().name : robot().source;
  if (!robot().couplings.empty() && info().laws.couplings.empty()) {
    throw ConfigError(source, "couplings",
                      "a robot without coupled joints: `" + info().name + "` does not simulate them",
                      fmt::format("{} of them", robot().couplings.size()));
  }
  if (!info().laws.implicit_servos.empty()) return;
  for (const int i : actuated_) {
    if (!is_implicit(robot().joint(i))) continue;
    throw ConfigError(source, fmt::format("servo of joint '{}'", robot().joint(i).name),
                      "an explicit servo: `" + info().name + "` does not solve implicit ones",
                      fmt::format("implicit_stiffness {:g}, implicit_damping {:g}",
                                  robot().joint(i).implicit_stiffness, robot().joint(i).implicit_damping));
  }
}

void PhysicsBackend::reset(const RobotState& state) {
  refuse_robot();
  const int n = robot().joint_count();
  if (state.q.size() != n || state.qd.size() != n) {
    throw ConfigError("reset", "joint vectors", fmt::format("{} joints ({})", n, robot().name),
                      fmt::format("q of {}, qd of {}", state.q.size(), state.qd.size()));
  }
  if (!std::isfinite(state.time) || !is_sane(state)) {
    throw ConfigError("reset", "state", "finite values and speeds that a robot can have",
                      "a value out of range");
  }
  if (std::abs(state.q_WB.norm() - 1) > 1e-6) {
    throw ConfigError("reset", "q_WB", "a unit quaternion", fmt::format("norm {}", state.q_WB.norm()));
  }
  diverged_ = false;
  push_.setZero();
  wrenches_.clear();
  torques_.setZero();
  servo_torques_.setZero();
  contacts_.clear();
  drives_.restart();
  do_reset(state);
  do_read_state(state_);
  state_.time = state.time;
}

void PhysicsBackend::compute_torques(const JointTargets& targets) noexcept {
  const RobotDescription& robot = *spec_.robot;
  servo_torques_.setZero();
  drives_.add_torques(targets, state_, servo_torques_);
  for (int i = 0; i < robot.joint_count(); ++i)
    torques_[i] = passive_torque(robot.joint(i), state_.q[i], state_.qd[i]) + servo_torques_[i];
}

// What implicit servos did in the step that was made.
void PhysicsBackend::add_implicit_torques() noexcept {
  for (const ImplicitServo& servo : implicit_servos()) {
    const double acceleration = (next_.qd[servo.joint] - state_.qd[servo.joint]) / spec_.physics_dt;
    const double torque = servo.torque_at(acceleration);
    torques_[servo.joint] += torque;
    servo_torques_[servo.joint] += torque;
  }
}

void PhysicsBackend::add_wrenches(JointVector& tau, Wrench& base) noexcept {
  const RobotDescription& robot = *spec_.robot;
  forward_kinematics(robot, state_, poses_);
  const Vector3 p_WC = poses_[0] * robot.bodies[0].inertia.p_BC;
  for (const BodyWrench& w : wrenches_) {
    const Vector3 p_WP = poses_[static_cast<std::size_t>(w.body)] * w.p_BP;
    base.force += w.wrench.force;
    base.torque += w.wrench.torque + (p_WP - p_WC).cross(w.wrench.force);
    for (int i = w.body; i > 0; i = robot.bodies[static_cast<std::size_t>(i)].parent) {
      const Pose& X_WJ = poses_[static_cast<std::size_t>(i)];
      const Vector3 moment = w.wrench.torque + (p_WP - X_WJ.translation()).cross(w.wrench.force);
      tau[i - 1] += (X_WJ.linear() * robot.joint(i - 1).axis).dot(moment);
    }
  }
}

StepStatus PhysicsBackend::advance(const JointTargets& targets) noexcept {
  compute_torques(targets);
  const double h = spec_.physics_dt;
  Wrench base{push_ / h};
  StepStatus status = StepStatus::kOk;
  if (wrenches_.empty()) {
    status = do_step(torques_, base);
  } else {
    JointVector tau = torques_;
    add_wrenches(tau, base);
    status = do_step(tau, base);
  }
  push_.setZero();
  do_read_state(next_);
  if (status != StepStatus::kOk || !is_sane(next_)) {
    diverged_ = true;
    return StepStatus::kDiverged;
  }
  add_implicit_torques();
  next_.time = state_.time + h;
  state_ = next_;
  contacts_.clear();
  do_read_contacts(contacts_);
  return StepStatus::kOk;
}

StepStatus PhysicsBackend::step(const JointTargets& targets, int substeps) noexcept {
  if (diverged_) return StepStatus::kDiverged;
  if (targets.q.size() != static_cast<Eigen::Index>(actuated_.size()) || !targets.q.allFinite()) {
    return StepStatus::kInvalidTargets;
  }
  for (int i = 0; i < substeps; ++i) {
    if (const StepStatus status = advance(targets); status != StepStatus::kOk) return status;
  }
  return StepStatus::kOk;
}

LegArray<FootContact> PhysicsBackend::foot_contacts() const noexcept {
  LegArray<FootContact> feet{};
  for (const Contact& c : contacts_) {
    if (c.leg < 0) continue;
    FootContact& foot = feet[static_cast<std::size_t>(c.leg)];
    const bool deepest = !foot.touching || -c.distance > foot.penetration;
    foot.force += c.force;
    if (c.force.dot(c.normal) <= 0) continue;
    foot.touching = true;
    if (deepest) {
      foot.p_WP = c.p_WP;
      foot.slip_speed = c.slip_speed;
      foot.penetration = std::max(0.0, -c.distance);
    }
  }
  return feet;
}

Pose PhysicsBackend::body_pose(int body) const {
  if (body < 0 || body > robot().joint_count()) {
    throw ConfigError("body_pose", "body", fmt::format("an index in [0, {}]", robot().joint_count()),
                      fmt::format("{}", body));
  }
  return do_body_pose(body);
}

SpatialInertia PhysicsBackend::body_inertia(int body) const {
  if (body < 0 || body > robot().joint_count()) {
    throw ConfigError("body_inertia", "body", fmt::format("an index in [0, {}]", robot().joint_count()),
                      fmt::format("{}", body));
  }
  return do_body_inertia(body);
}

void PhysicsBackend::apply_push(const Vector3& impulse) {
  if (!impulse.allFinite())
    throw ConfigError("apply_push", "impulse", "three finite numbers, N s", "not finite");
  push_ += impulse;
}

void PhysicsBackend::apply_wrench(const BodyWrench& wrench) {
  constexpr std::string_view kSource = "apply_wrench";
  if (wrench.body < 0 || wrench.body > robot().joint_count()) {
    throw ConfigError(kSource, "body", fmt::format("an index in [0, {}]", robot().joint_count()),
                      fmt::format("{}", wrench.body));
  }
  if (!wrench.wrench.force.allFinite() || !wrench.wrench.torque.allFinite() || !wrench.p_BP.allFinite())
    throw ConfigError(kSource, "wrench", "finite force (N), torque (N m) and point (m)", "not finite");
  if (wrenches_.size() == kMaxWrenches) {
    throw ConfigError(kSource, "wrenches", fmt::format("at most {} at once", kMaxWrenches),
                      fmt::format("{}", kMaxWrenches + 1));
  }
  wrenches_.push_back(wrench);
}

Snapshot PhysicsBackend::save() const {
  Snapshot snapshot{info().name, state_,    contacts_, torques_, servo_torques_,
                    push_,       diverged_, {},        {},       wrenches_};
  drives_.save(snapshot.drives);
  do_save(snapshot.engine);
  return snapshot;
}

void PhysicsBackend::restore(const Snapshot& snapshot) {
  if (snapshot.engine_name != info().name) {
    throw ConfigError("restore", "engine", fmt::format("a snapshot of {}", info().name),
                      snapshot.engine_name);
  }
  std::vector<double> own;
  do_save(own);
  if (own.size() != snapshot.engine.size() || !drives_.can_restore(snapshot.drives) ||
      snapshot.state.q.size() != state_.q.size() || snapshot.state.qd.size() != state_.qd.size() ||
      !snapshot.state.is_finite() || snapshot.torques.size() != torques_.size() ||
      snapshot.servo_torques.size() != servo_torques_.size()) {
    throw ConfigError(
        "restore", "robot",
        fmt::format("a snapshot of {} with {} joints, in finite numbers", robot().name, state_.q.size()),
        fmt::format("{} joints", snapshot.state.q.size()));
  }
  check_indices(snapshot, robot());
  do_restore(snapshot.engine);
  drives_.restore(snapshot.drives);
  state_ = snapshot.state;
  contacts_ = snapshot.contacts;
  torques_ = snapshot.torques;
  servo_torques_ = snapshot.servo_torques;
  push_ = snapshot.push;
  diverged_ = snapshot.diverged;
  wrenches_ = snapshot.wrenches;
}

}  // namespace crossgait
