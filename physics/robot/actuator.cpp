#include "physics/robot/actuator.h"

#include <algorithm>
#include <cmath>

namespace crossgait {
namespace {

// What is left of a torque limit in a direction in which the joint turns at `speed`, rad/s.
double available(const Joint& joint, double limit, double speed) noexcept {
  if (joint.no_load_speed <= 0) return limit;
  const double share = (joint.no_load_speed - speed) / (joint.no_load_speed - joint.corner_speed);
  return limit * std::clamp(share, 0.0, 1.0);
}

double through_play(const Joint& joint, double error, double qd) noexcept {
  const double play = joint.backlash / 2;
  if (error > play) return std::max(joint.kp * (error - play) - joint.kd * qd, 0.0);
  if (error < -play) return std::min(joint.kp * (error + play) - joint.kd * qd, 0.0);
  return 0;
}

}  // namespace

std::optional<ImplicitServo> implicit_servo(const Joint& joint, int index, double target, double measured,
                                            double qd, double h) noexcept {
  const double play = joint.backlash / 2, away = target - measured;
  if (std::abs(away) <= play && play > 0) return std::nullopt;
  const double error = away - std::copysign(play, away);
  ImplicitServo servo{.joint = index,
                      .torque = joint.kp * (error - joint.implicit_stiffness * h * qd) - joint.kd * qd,
                      .inertia = servo_inertia(joint, h),
                      .lower = -available(joint, negative_effort(joint), -qd),
                      .upper = available(joint, joint.effort_limit, qd)};
  if (play > 0) (away > 0 ? servo.lower : servo.upper) = 0;  // it does not pull back through the play
  if (!(servo.lower < servo.upper)) return std::nullopt;
  return servo;
}

double servo_torque(const Joint& joint, double target, double measured, double qd) noexcept {
  const double error = target - measured;
  const double wanted =
      joint.backlash > 0 ? through_play(joint, error, qd) : joint.kp * error - joint.kd * qd;
  return std::clamp(wanted, -available(joint, negative_effort(joint), -qd),
                    available(joint, joint.effort_limit, qd));
}

}  // namespace crossgait
