#include "env/reward.h"

#include <algorithm>
#include <cmath>

#include "physics/core/find_row.h"

namespace crossgait {
namespace {

using Record = StepRecord;

// Widths of the tracking terms: an error of this size is worth 1/e.
constexpr double kVelocityWidth = 0.1;  // m/s of the reference size, half of the speed of a trot
constexpr double kYawRateWidth = 0.5;   // rad/s of the reference size
constexpr double kLeastSpeed = 0.02;    // m/s, so that a standing robot's cost of transport stays finite

double square(double x) { return x * x; }

double squared_difference(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) sum += square(a[i] - b[i]);
  return sum;
}

double contact_pattern(const Record& r) {
  double sum = 0;
  for (const Leg leg : kLegs) sum += r.contacts[leg].touching != r.swing[leg] ? 0.2 : -0.5;
  return sum;
}

double joint_acceleration(const Record& r) {
  double sum = 0;
  for (const int i : r.servos) sum += square((r.after.qd[i] - r.before.qd[i]) / r.dt);
  return sum;
}

// Mean over the physics steps of this step; zero where there was none (it diverged in the first).
double mean(double MotionIntegrals::*integral, const Record& r) {
  return r.during.seconds > 0 ? r.during.*integral / r.during.seconds : 0;
}

// Work over weight times way, as the statistic of that name: the speed is the mean of the step as well.
double cost_of_transport(const Record& r) {
  if (r.during.seconds <= 0) return 0;
  const double way = (r.after.p_WB - r.before.p_WB).head<2>().norm();
  return r.during.work / (r.weight * std::max(way, kLeastSpeed * r.during.seconds));
}

constexpr std::array kTerms{
    RewardTerm{"forward_velocity", "m/s", "velocity along the direction faced at the start", 2000,
               [](const Record& r) { return r.v_start.x(); }},
    RewardTerm{"lateral_velocity", "m/s", "speed across it", -2,
               [](const Record& r) { return std::abs(r.v_start.y()); }},
    RewardTerm{"contact_pattern", "-", "for every leg 0.2 if it touches or not as the gait says, else -0.5",
               1, contact_pattern},
    RewardTerm{"orientation_l2", "deg^2", "roll^2 + pitch^2 + yaw^2, yaw since the start", -2,
               [](const Record& r) { return (kDegreesPerRadian * r.roll_pitch_yaw).squaredNorm(); }},
    RewardTerm{"joint_acc_l2", "rad^2/s^4", "sum of squared servo accelerations", -0.1, joint_acceleration},
    RewardTerm{"parameter_rate_l2", "mixed", "sum of squared changes of the adapted parameters", -5,
               [](const Record& r) { return squared_difference(r.parameters, r.last_parameters); }},
    RewardTerm{"velocity_tracking", "-",
               "exp(-|v_xy - commanded|^2 / (0.1 m/s x root of size)^2), in the heading frame", 0,
               [](const Record& r) {
                 return std::exp(
                     -(square(r.v_heading.x() - r.command.vx) + square(r.v_heading.y() - r.command.vy)) /
                     (square(kVelocityWidth) * r.size));
               }},
    RewardTerm{"velocity_error", "m/s",
               "|v_xy - commanded| in the heading frame: tells far from the command too", 0,
               [](const Record& r) {
                 return std::hypot(r.v_heading.x() - r.command.vx, r.v_heading.y() - r.command.vy);
               }},
    RewardTerm{"forward_velocity_ratio", "-",
               "velocity along the direction faced at the start over the commanded one, -1 to 1; 0 if none "
               "is asked for",
               0,
               [](const Record& r) {
                 return r.command.vx > 0 ? std::clamp(r.v_start.x() / r.command.vx, -1.0, 1.0) : 0;
               }},
    RewardTerm{"yaw_rate_tracking", "-", "exp(-(yaw rate - commanded)^2 / (0.5 rad/s / root of size)^2)", 0,
               [](const Record& r) {
                 return std::exp(-square((r.after.w_WB.z() - r.command.yaw_rate) / kYawRateWidth) * r.size);
               }},
    RewardTerm{"yaw_rate_error", "rad/s", "|yaw rate - commanded|", 0,
               [](const Record& r) { return std::abs(r.after.w_WB.z() - r.command.yaw_rate); }},
    RewardTerm{"vertical_velocity", "m^2/s^2", "squared velocity of the base along z", 0,
               [](const Record& r) { return square(r.after.v_WB.z()); }},
    RewardTerm{"tilt_rate", "rad^2/s^2", "squared angular velocity of the base about the horizontal axes", 0,
               [](const Record& r) { return r.after.w_WB.head<2>().squaredNorm(); }},
    RewardTerm{"flat_orientation_l2", "-",
               "squared horizontal part of the direction of gravity in the base's frame", 0,
               [](const Record& r) {
                 const Vector3 down = r.after.q_WB.conjugate() * Vector3(0, 0, -1);
                 return down.head<2>().squaredNorm();
               }},
    RewardTerm{"base_height_l2", "m^2", "squared difference from the standing height over the ground", 0,
               [](const Record& r) { return square(r.height - r.standing_height); }},
    RewardTerm{"alive", "-", "one for every step", 0, [](const Record&) { return 1.0; }},
    RewardTerm{"termination", "-", "one for the step that ends an episode by a fall or another failure", 0,
               [](const Record& r) { return r.terminated ? 1.0 : 0.0; }},
    RewardTerm{"action_rate_l2", "-", "sum of squared changes of the action", 0,
               [](const Record& r) { return squared_difference(r.action, r.last_action); }},
    RewardTerm{"action_l2", "-", "sum of squares of the action", 0,
               [](const Record& r) {
                 double sum = 0;
                 for (const double a : r.action) sum += square(a);
                 return sum;
               }},
    RewardTerm{"foot_slip", "m^2/s^2",
               "sum of squared slip speeds of the feet that touch, mean over the step", 0,
               [](const Record& r) { return mean(&MotionIntegrals::slip_squares, r); }},
    RewardTerm{"joint_torques_l2", "N^2 m^2",
               "sum of squared torques of the servo joints, passive damping included, mean over the step", 0,
               [](const Record& r) { return mean(&MotionIntegrals::torque_squares, r); }},
    RewardTerm{"power", "W", "sum of |servo torque x joint velocity|, mean over the step", 0,
               [](const Record& r) { return mean(&MotionIntegrals::work, r); }},
    RewardTerm{"cost_of_transport", "-",
               "work of the servos over weight times way over the ground (at least 0.02 m/s), of the step", 0,
               cost_of_transport},
};
static_assert(kTerms.size() <= RewardTerms::kMost);

}  // namespace

std::span<const RewardTerm> reward_terms() { return kTerms; }

std::size_t RewardTerms::size() noexcept { return kTerms.size(); }

std::size_t find_reward_term(std::string_view name) {
  return static_cast<std::size_t>(&find_row(kTerms, name, "reward", "term") - kTerms.data());
}

RewardTerms guide_reward_weights() {
  RewardTerms weights{};
  for (std::size_t i = 0; i < kTerms.size(); ++i) weights[i] = kTerms[i].guide_weight;
  return weights;
}

double evaluate_reward(const StepRecord& record, const RewardTerms& weights, RewardTerms& terms) noexcept {
  double sum = 0;
  for (std::size_t i = 0; i < kTerms.size(); ++i) {
    terms[i] = weights[i] == 0 ? 0 : weights[i] * kTerms[i].value(record);
    sum += terms[i];
  }
  return sum;
}

}  // namespace crossgait
