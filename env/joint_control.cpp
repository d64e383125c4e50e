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
      home_(model.joints.home),
      scale_(model.joints.scale),
      standing_(posture_at(*robot_, model.joints)) {
  const std::vector<int> actuated = robot_->actuated_joints();
  wanted_.q.resize(static_cast<Eigen::Index>(actuated.size()));
  for (const int servo : model.joints.servos)
    slots_.push_back(std::find(actuated.begin(), actuated.end(), servo) - actuated.begin());
  const double delay = model.config.joints.delay;
  if (delay > 0) line_.resize(static_cast<std::size_t>(step_count(delay, model.config.control_dt)));
  restart(model.config.command);
}

void JointControl::restart(const std::optional<VelocityCommand>& command) {
  command_ = command;
  for (std::size_t i = 0; i < slots_.size(); ++i) wanted_.q[slots_[i]] = home_[i];
  std::fill(line_.begin(), line_.end(), wanted_);
  oldest_ = 0;
}

void JointControl::apply(std::span<const double> action) noexcept {
  for (std::size_t i = 0; i < slots_.size(); ++i) wanted_.q[slots_[i]] = home_[i] + scale_[i] * action[i];
}

RobotState JointControl::initial_state(const Terrain& terrain, const Placement& placement) const {
  return standing_on(terrain, placement, *robot_, standing_);
}

void JointControl::hold_pose(double /*dt*/, ControlTargets& out) noexcept {
  out.joints = line_.empty() ? wanted_ : line_[oldest_];
}

void JointControl::advance(double dt, ControlTargets& out) noexcept {
  hold_pose(dt, out);
  out.velocity = command_;
  if (line_.empty()) return;
  line_[oldest_] = wanted_;
  oldest_ = (oldest_ + 1) % line_.size();
}

}  // namespace crossgait
