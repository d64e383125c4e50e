#include "env/joint_control.h"

#include <algorithm>

#include "motion/standing.h"
#include "motion/time_steps.h"

namespace crossgait {
namespace {

// All joints of the robot with its servos at `home`: loops closed.
JointVector posture_at(const RobotDescription& robot, const JointActionTable& table) {
  JointVector q = robot.home;
  for (std::size_t i = 0; i < table.servos.size(); ++i) q[table.servos[i]] = table.home[i];
  return with_legs_closed(robot, q, "joints.home");
}

// Of which an action gives the torque, or the velocity that the torque follows.
bool is_rate(JointCommand command) noexcept {
  return command == JointCommand::kTorque || command == JointCommand::kVelocity;
}

}  // namespace

JointControl::JointControl(const EnvModel& model)
    : robot_(model.world.robot),
      table_(model.joints),
      filter_(model.config.joints.filter),
      computed_(model.config.joints.commands_torques()),
      standing_(posture_at(*robot_, model.joints)),
      network_(model.actuator) {
  if (network_ != nullptr) memories_.resize(table_.servos.size(), network_->begin());
  wanted_.q.resize(static_cast<Eigen::Index>(robot_->actuated_joints().size()));
  by_torque_ = wanted_;
  const double delay = model.config.joints.delay;
  if (delay > 0) line_.resize(static_cast<std::size_t>(step_count(delay, model.config.control_dt)));
  restart(model.config.command);
}

void JointControl::restart(const std::optional<VelocityCommand>& command) {
  command_ = command;
  for (std::size_t i = 0; i < table_.slots.size(); ++i) {
    wanted_.q[table_.slots[i]] = is_rate(table_.commands[i]) ? 0 : table_.home[i];
    by_torque_.q[table_.slots[i]] = table_.home[i];
  }
  for (ActuatorNetwork::Memory& memory : memories_) network_->restart(memory);
  std::fill(line_.begin(), line_.end(), wanted_);
  oldest_ = 0;
}

double JointControl::target(std::size_t i, double action, const RobotState& state) const noexcept {
  const double by_action = table_.scale[i] * action;
  switch (table_.commands[i]) {
    case JointCommand::kTorque:
    case JointCommand::kVelocity:
      return std::clamp(by_action, table_.lower[i], table_.upper[i]);
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
  if (!computed_) return;
  const JointTargets& asked = line_.empty() ? wanted_ : line_[oldest_];
  for (std::size_t i = 0; i < table_.slots.size(); ++i) {
    const int servo = table_.servos[i];
    const Joint& gains = robot_->joint(servo);
    const double q = state.q[servo], qd = state.qd[servo], wanted = asked.q[table_.slots[i]];
    double& target = by_torque_.q[table_.slots[i]];
    if (table_.commands[i] == JointCommand::kTorque) {
      target = q + (wanted + gains.kd * qd) / gains.kp;
    } else if (table_.commands[i] == JointCommand::kVelocity) {
      target = q + gains.kd * wanted / gains.kp;
    } else if (network_ != nullptr) {
      target = q + (network_->torque(wanted - q, qd, memories_[i]) + gains.kd * qd) / gains.kp;
    } else {
      target = wanted;
    }
  }
}

RobotState JointControl::initial_state(const Terrain& terrain, const Placement& placement) const {
  return standing_on(terrain, placement, *robot_, standing_);
}

void JointControl::hold_pose(double /*dt*/, ControlTargets& out) noexcept {
  out.joints = computed_ ? by_torque_ : line_.empty() ? wanted_ : line_[oldest_];
}

void JointControl::advance(double dt, ControlTargets& out) noexcept {
  hold_pose(dt, out);
  out.velocity = command_;
  if (line_.empty()) return;
  line_[oldest_] = wanted_;
  oldest_ = (oldest_ + 1) % line_.size();
}

}  // namespace crossgait
