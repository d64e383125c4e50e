#include "physics/robot/drives.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/random.h"
#include "physics/robot/actuator.h"

namespace crossgait {
namespace {

constexpr double kMostDelaySteps = 1000;

std::size_t delay_steps(const Joint& joint, double physics_dt, const std::string& source) {
  const double steps = std::round(joint.delay / physics_dt);
  const bool whole = std::abs(joint.delay - steps * physics_dt) < 1e-9 * physics_dt * (1 + steps);
  if (whole && steps <= kMostDelaySteps) return static_cast<std::size_t>(steps);
  throw ConfigError(
      source, fmt::format("delay of joint '{}'", joint.name),
      fmt::format("a whole number of physics steps of {:g} s, at most {:g}", physics_dt, kMostDelaySteps),
      fmt::format("{:g} s", joint.delay));
}

// Uniform in +-noise; of nothing but the step and the joint, so that a restored motion draws the same.
double error_of(double noise, std::uint64_t step, int joint) noexcept {
  const std::uint64_t bits = derived_seed(step, static_cast<std::uint64_t>(joint));
  return noise * (2 * (static_cast<double>(bits >> 11) * 0x1p-53) - 1);
}

}  // namespace

Drives::Drives(const RobotDescription& robot, double physics_dt) : physics_dt_(physics_dt) {
  std::size_t longest = 0;
  for (const int i : robot.actuated_joints()) {
    const Joint& joint = robot.joint(i);
    const double left = joint.lag > 0 ? std::exp(-physics_dt / joint.lag) : 0;
    servos_.push_back({i, delay_steps(joint, physics_dt, robot.source), left, joint});
    longest = std::max(longest, servos_.back().delay);
  }
  held_ = JointVector::Zero(static_cast<Eigen::Index>(servos_.size()));
  line_.assign(longest + 1, held_);
  implicit_.reserve(servos_.size());
}

void Drives::add_torques(const JointTargets& targets, const RobotState& state,
                         JointVector& torques) noexcept {
  if (steps_ == 0) std::fill(line_.begin(), line_.end(), targets.q);
  const std::size_t rows = line_.size(), now = steps_ % rows;
  line_[now] = targets.q;
  implicit_.clear();
  for (std::size_t k = 0; k < servos_.size(); ++k) {
    const Servo& servo = servos_[k];
    const Joint& joint = servo.joint;
    const double asked = line_[(now + rows - servo.delay) % rows][static_cast<Eigen::Index>(k)];
    const double target = clip_target(joint, asked);
    double& held = held_[static_cast<Eigen::Index>(k)];
    if (steps_ == 0) held = target;
    double measured = state.q[servo.index];
    if (joint.sensor_noise > 0) measured += error_of(joint.sensor_noise, steps_, servo.index);
    const double follows = servo.left > 0 ? held : target, qd = state.qd[servo.index];
    if (!is_implicit(joint)) {
      torques[servo.index] += servo_torque(joint, follows, measured, qd);
    } else if (const auto row = implicit_servo(joint, servo.index, follows, measured, qd, physics_dt_)) {
      implicit_.push_back(*row);
    }
    held = target + servo.left * (held - target);
  }
  ++steps_;
}

void Drives::save(std::vector<double>& out) const {
  out.push_back(static_cast<double>(steps_));
  for (const JointVector& row : line_) out.insert(out.end(), row.begin(), row.end());
  out.insert(out.end(), held_.begin(), held_.end());
}

bool Drives::can_restore(const std::vector<double>& saved) const noexcept {
  constexpr double kMost = 1e18;  // of targets and of counted steps
  std::size_t size = 1 + static_cast<std::size_t>(held_.size());
  for (const JointVector& row : line_) size += static_cast<std::size_t>(row.size());
  return saved.size() == size && saved.front() >= 0 &&
         std::all_of(saved.begin(), saved.end(), [](double number) { return std::abs(number) < kMost; });
}

void Drives::restore(const std::vector<double>& saved) {
  const double* next = saved.data();
  steps_ = static_cast<std::uint64_t>(*next++);
  for (JointVector& row : line_) {
    std::copy_n(next, row.size(), row.begin());
    next += row.size();
  }
  std::copy_n(next, held_.size(), held_.begin());
}

}  // namespace crossgait
