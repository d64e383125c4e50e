#include "env/joint_control.h"

#include <algorithm>

#include <fmt/format.h>

#include "ik/leg_kinematics.h"
#include "motion/standing.h"
#include "motion/time_steps.h"
#include "physics/core/error.h"

namespace crossgait {
namespace {

// All joints of the robot with its servos at `home`: loops closed.
JointVector posture_at(const RobotDescription& robot, const JointActionTable& table) {
  JointVector q = robot.home;
  for (std::size_t i = 0; i < table.servos.size(); ++i) q[table.servos[i]] = table.home[i];
  for (const Leg leg : kLegs) {
    const LegKinematics kinematics = make_leg_kinematics(robot, leg);
    if (kinematics.passive_count() == 0) continue;
    ServoVector servos(kinematics.servo_count());
    for (Eigen::Index k = 0; k < servos.size(); ++k)
      servos[k] = q[kinematics.servo_joints()[static_cast<std::size_t>(k)]];
    const LegForward forward = kinematics.forward(servos);
    if (!forward.closed)
      throw ConfigError(robot.source, fmt::format("joints.home of {}", name(leg)),
                        "angles at which the chains of the leg meet", "others");
    for (Eigen::Index k = 0; k < forward.passive.size(); ++k)
      q[kinematics.passive_joints()[static_cast<std::size_t>(k)]] = forward.passive[k];
  }
  return q;
}

}  // namespace

JointControl::JointControl(const EnvModel& model)
    : robot_(model.world.robot),
      table_(model.joints),
      filter_(model.config.joints.filter),
      standing_(posture_at(*robot_, model.joints)) {
  wanted_.q.resize(static_cast<Eigen::Index>(robot_->actuated_joints().size()));
  by_torque_ = wanted_;
  const double delay = model.config.joints.delay;
  if (delay > 0) line_.resize(static_cast<std::size_t>(step_count(delay, model.config.control_dt)));
  restart(model.config.command);
}

void JointControl::restart(const std::optional<VelocityCommand>& command) {
  command_ = command;
  const bool torques = table_.command == JointCommand::kTorque;
  for (std::size_t i = 0; i < table_.slots.size(); ++i) {
    wanted_.q[table_.slots[i]] = torques ? 0 : table_.home[i];
    by_torque_.q[table_.slots[i]] = table_.home[i];
  }
  std::fill(line_.begin(), line_.end(), wanted_);
  oldest_ = 0;
}

double JointControl::target(std::size_t i, double action, const RobotState& state) const noexcept {
  const double by_action = table_.scale[i] * action;
  switch (table_.command) {
    case JointCommand::kTorque:
      return by_action;
    case JointCommand::kRelative:
      return std::clamp(state.q[table_.servos[i]] + by_action, table_.lower[i], table_.upper[i]);
    case JointCommand::kPosition:
      break;
  }
  return std::clamp(table_.offset[i] + by_action, table_.lower[i], table_.upper[i]);
}

void JointControl::apply(std::span<const double> action, const RobotState& state) noexcept {
  for (std::size_t i = 0; i < table_.slots.size(); ++i) {
    double& wanted = wanted_.q[table_.slots[i]];
    const double next = target(i, action[i], state);
    wanted = filter_ == 1 ? next : filter_ * next + (1 - filter_) * wanted;
  }
}

// A servo's torque is kp (target - q) - kd qd, of the state in which the step begins: the target at which
// that is the wanted torque.
void JointControl::observe(const RobotState& state, double /*dt*/) noexcept {
  if (table_.command != JointCommand::kTorque) return;
  const JointTargets& torques = line_.empty() ? wanted_ : line_[oldest_];
  for (std::size_t i = 0; i < table_.slots.size(); ++i) {
    const int servo = table_.servos[i];
    const Joint& gains = robot_->joint(servo);
    by_torque_.q[table_.slots[i]] =
        state.q[servo] + (torques.q[table_.slots[i]] + gains.kd * state.qd[servo]) / gains.kp;
  }
}

RobotState JointControl::initial_state(const Terrain& terrain, const Placement& placement) const {
  return standing_on(terrain, placement, *robot_, standing_);
}

void JointControl::hold_pose(double /*dt*/, ControlTargets& out) noexcept {
  const bool torques = table_.command == JointCommand::kTorque;
  out.joints = torques ? by_torque_ : line_.empty() ? wanted_ : line_[oldest_];
}

void JointControl::advance(double dt, ControlTargets& out) noexcept {
  hold_pose(dt, out);
  out.velocity = command_;
  if (line_.empty()) return;
  line_[oldest_] = wanted_;
  oldest_ = (oldest_ + 1) % line_.size();
}

}  // namespace crossgait
