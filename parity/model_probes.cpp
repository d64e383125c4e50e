#include "parity/model_probes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "physics/core/across_axis.h"
#include "physics/engine/contact_features.h"
#include "physics/robot/actuator.h"
#include "physics/robot/multibody.h"

namespace crossgait::probes {
namespace {

constexpr double kHighUp = 100;       // m above the highest ground: nothing touches
constexpr double kPressDepth = 1e-3;  // m
// Undone in one step a depth throws light feet off the ground at depth over step: 1 mm/s of this.
constexpr double kThinPressDepth = 1e-6;  // m

JointTargets targets_at(const RobotDescription& robot, const JointVector& q) {
  const std::vector<int> actuated = robot.actuated_joints();
  JointTargets targets{JointVector::Zero(static_cast<Eigen::Index>(actuated.size()))};
  for (std::size_t k = 0; k < actuated.size(); ++k) targets.q[static_cast<Eigen::Index>(k)] = q[actuated[k]];
  return targets;
}

RobotState high_up(const PhysicsBackend& world) {
  RobotState state = world.home_state();
  state.p_WB.z() += kHighUp;
  return state;
}

double torque_of(PhysicsBackend& world, const RobotState& state, int joint, double target) {
  world.reset(state);
  JointVector q = state.q;
  q[joint] = target;
  return world.step(targets_at(world.robot(), q)) == StepStatus::kOk
             ? world.torques()[joint]
             : std::numeric_limits<double>::infinity();
}

/// The same torque as if the joint did not accelerate in the step: what an implicit servo's falls by depends
/// on all that the joint is part of.
double torque_at_rest(PhysicsBackend& world, const RobotState& state, int joint, double target) {
  const double torque = torque_of(world, state, joint, target);
  const double h = world.spec().physics_dt, acceleration = (world.state().qd[joint] - state.qd[joint]) / h;
  return torque + servo_inertia(world.robot().joint(joint), h) * acceleration;
}

/// Inertia that the joint moves with all else free, kg m^2.
double free_inertia(const PhysicsBackend& world, int joint) {
  const Eigen::MatrixXd M = world.mass_matrix();
  const Eigen::Index at = M.rows() - world.robot().joint_count() + joint;
  return 1 / M.inverse()(at, at);
}

/// Velocity of the point of `body` that is at `p_WP` now, m/s.
Vector3 point_velocity(const RobotDescription& robot, const RobotState& state, int body,
                       const Vector3& p_WP) {
  constexpr double kShort = 1e-6;  // s: of a foot at 10 m/s on a shank of 0.1 m the rest is 1e-3 m/s
  const auto b = static_cast<std::size_t>(body);
  std::vector<Pose> now, then;
  forward_kinematics(robot, state, now);
  RobotState moved = state;
  moved.p_WB += kShort * state.v_WB;
  const Vector3 turn = kShort * state.w_WB;
  if (turn.norm() > 0)
    moved.q_WB = Quaternion(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * state.q_WB;
  moved.q += kShort * state.qd;
  forward_kinematics(robot, moved, then);
  return (then[b] * (now[b].inverse() * p_WP) - p_WP) / kShort;
}

}  // namespace

double time_of_a_step(PhysicsBackend& world) {
  const RobotState state = high_up(world);
  world.reset(state);
  return world.step(targets_at(world.robot(), state.q)) == StepStatus::kOk
             ? world.state().time - state.time
             : std::numeric_limits<double>::infinity();
}

std::vector<Pose> poses_with_turned(PhysicsBackend& world, int turned) {
  RobotState state = high_up(world);
  state.q.setZero();
  if (turned >= 0) state.q[turned] = 0.5;
  world.reset(state);
  std::vector<Pose> poses{Pose::Identity()};
  for (int i = 1; i <= world.robot().joint_count(); ++i) {
    const int parent = world.robot().bodies[static_cast<std::size_t>(i)].parent;
    poses.push_back(world.body_pose(parent).inverse() * world.body_pose(i));
  }
  return poses;
}

Eigen::VectorXd joint_inertias(PhysicsBackend& world) {
  world.reset(high_up(world));
  return world.mass_matrix().diagonal().tail(world.robot().joint_count());
}

Vector3 free_fall(PhysicsBackend& world) {
  const RobotState state = high_up(world);
  world.reset(state);
  if (world.step(targets_at(world.robot(), state.q)) != StepStatus::kOk)
    return Vector3::Constant(std::numeric_limits<double>::infinity());
  return world.state().v_WB / (world.state().time - state.time);
}

ServoResponse servo_response(PhysicsBackend& world, int joint) {
  constexpr double kSpeed = 0.1, kSmall = 1e-3;  // rad/s, rad
  const Joint& of = world.robot().joint(joint);
  RobotState rest = high_up(world), turning = rest;
  turning.qd[joint] = kSpeed;
  ServoResponse response;
  if (!of.actuated) {
    response.joint_damping = -torque_of(world, turning, joint, rest.q[joint]) / kSpeed;
    return response;
  }
  // From this far away a target takes all of the torque; further off, what keeps joints within their limits
  // would throw the robot about.
  const double give =
      is_implicit(of) ? servo_inertia(of, world.spec().physics_dt) / free_inertia(world, joint) : 0;
  const double range = std::min(1e3, 2 * (1 + give) * std::max(of.effort_limit, of.effort_negative) / of.kp);
  RobotState outside = rest;
  outside.q[joint] -= range;
  RobotState outside_turning = outside;
  outside_turning.qd[joint] = kSpeed;
  response.effort_limit = torque_of(world, outside, joint, rest.q[joint]);
  response.joint_damping =
      (response.effort_limit - torque_of(world, outside_turning, joint, rest.q[joint])) / kSpeed;
  response.stiffness = torque_at_rest(world, rest, joint, rest.q[joint] + kSmall) / kSmall;
  response.servo_damping =
      -torque_at_rest(world, turning, joint, rest.q[joint]) / kSpeed - response.joint_damping;
  return response;
}

RobotState pressed(const PhysicsBackend& world, double speed) {
  const RobotDescription& robot = world.robot();
  const Capabilities& can = world.info().capabilities;
  const double depth = can.soft_contact || can.error_reduction ? kPressDepth : kThinPressDepth;
  RobotState state = world.home_state();
  std::vector<Pose> poses;
  forward_kinematics(robot, state, poses);
  double gap = std::numeric_limits<double>::infinity();
  for (const Leg leg : kLegs) {
    const Vector3 foot = foot_position(robot, leg, poses);
    const double radius = (*robot.legs)[leg].foot_radius;
    gap = std::min(gap, foot.z() - radius - world.spec().terrain.height(foot.x(), foot.y()));
  }
  state.p_WB.z() -= gap + depth;
  state.v_WB.x() = speed;
  return state;
}

LegArray<PressedFoot> press_feet(PhysicsBackend& world, const RobotState& pressed) {
  world.reset(pressed);
  LegArray<PressedFoot> feet{};
  if (world.step(targets_at(world.robot(), pressed.q)) != StepStatus::kOk) return feet;
  LegArray<double> slip;
  slip.fill(std::numeric_limits<double>::infinity());
  for (const Contact& c : world.contacts()) {
    if (c.leg < 0 || c.distance > 0) continue;
    PressedFoot& foot = feet[static_cast<std::size_t>(c.leg)];
    const double normal = c.force.dot(c.normal);
    foot.depth = std::max(foot.depth, -c.distance);
    foot.normal_force += normal;
    if (normal <= 0) continue;
    foot.friction_ratio = (c.force - normal * c.normal).norm() / normal;
    const Vector3 v = point_velocity(world.robot(), world.state(), c.body, c.p_WP);
    slip[static_cast<std::size_t>(c.leg)] =
        std::min(slip[static_cast<std::size_t>(c.leg)], (v - c.normal * c.normal.dot(v)).norm());
  }
  for (const Leg leg : kLegs) feet[leg].slip_after = std::isfinite(slip[leg]) ? slip[leg] : 0;
  return feet;
}

std::optional<RobotState> body_pressed(const PhysicsBackend& world, int body, const Quaternion& attitude) {
  const RobotDescription& robot = world.robot();
  RobotState state = world.home_state();
  state.q_WB = attitude;
  std::vector<Pose> poses;
  forward_kinematics(robot, state, poses);
  double gap = std::numeric_limits<double>::infinity();
  for (const ContactFeature& feature : contact_features(robot, world.spec().fixed_base)) {
    if (feature.body != body) continue;
    const auto b = static_cast<std::size_t>(body);
    const Pose X_WG = poses[b] * robot.bodies[b].shapes[static_cast<std::size_t>(feature.shape)].X_BG;
    const Vector3 axis = X_WG.linear() * feature.axis_G;
    const Vector3 down = across(-Vector3::UnitZ(), axis).stableNormalized();
    const Vector3 lowest = X_WG * feature.p_GC + feature.rim * down;
    gap = std::min(gap, lowest.z() - feature.radius - world.spec().terrain.height(lowest.x(), lowest.y()));
  }
  if (!std::isfinite(gap)) return std::nullopt;
  state.p_WB.z() -= gap + kPressDepth;
  return state;
}

std::optional<PressedBody> press_body(PhysicsBackend& world, const RobotState& pressed, int body) {
  world.reset(pressed);
  if (world.step(targets_at(world.robot(), pressed.q)) != StepStatus::kOk) return std::nullopt;
  PressedBody result;
  for (const Contact& c : world.contacts()) {
    if (c.body != body || c.distance > 0) continue;
    result.depth = std::max(result.depth, -c.distance);
    ++result.points;
  }
  return result;
}

RobotState swinging(const PhysicsBackend& world) {
  RobotState state = high_up(world);
  state.w_WB = {1, 2, 3};
  for (Eigen::Index i = 0; i < state.q.size(); ++i) {
    state.q[i] += 0.02 * std::sin(static_cast<double>(i));  // opens the loops by a millimetre
    state.qd[i] = std::cos(2.0 * static_cast<double>(i));
  }
  return state;
}

Eigen::VectorXd swing(PhysicsBackend& world, const RobotState& state) {
  world.reset(state);
  Eigen::VectorXd velocity(6 + state.q.size());
  if (world.step(targets_at(world.robot(), state.q)) != StepStatus::kOk)
    return velocity.setConstant(std::numeric_limits<double>::infinity());
  velocity << world.state().v_WB, world.state().w_WB, world.state().qd;
  return velocity;
}

}  // namespace crossgait::probes
