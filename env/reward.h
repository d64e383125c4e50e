// What a step was worth: a table of named terms, each a function of one step's record.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gait/velocity_command.h"
#include "motion/motion_statistics.h"
#include "physics/core/math.h"
#include "physics/robot/state.h"

namespace crossgait {

/// Holds everything that a reward may look at: one policy step, from the instant before it to the one after.
/// Vectors are those of the environment; references are valid during the call alone.
struct StepRecord {
  double dt;  ///< of the policy step, s
  const RobotState& before;
  const RobotState& after;
  Vector3 v_start;          ///< velocity of the base in the frame it faced when the episode began, m/s
  Vector3 v_heading;        ///< the same in the frame it faces now (yaw alone), m/s
  Vector3 roll_pitch_yaw;   ///< after the step, yaw since the episode began, rad
  double height;            ///< of the base's origin over the ground below it, m
  double standing_height;   ///< the same when the episode began, m
  VelocityCommand command;  ///< asked of the body
  const LegArray<FootContact>& contacts;
  LegArray<bool> swing;                                 ///< the gait has the leg in the air
  std::span<const double> action, last_action;          ///< clipped to [-1, 1]; zeros before the first step
  std::span<const double> parameters, last_parameters;  ///< that adapt, in their units
  std::span<const int> servos;                          ///< indices of the actuated joints
  double weight;                                        ///< of the robot, N
  MotionIntegrals during;                               ///< integrals over the physics steps of this step
  double size = 1;  ///< of the robot, in reference sizes: widths of speeds go with its root (gait/scale.h)
  bool terminated;  ///< the episode ended by an outcome: a fall, divergence, ... (EnvConfig::terminations)
};

/// A row of the table describes a term. The reward is the sum of weight times value.
struct RewardTerm {
  std::string_view name, unit, help;
  double guide_weight;  ///< in the guide's reward; zero if it has no such term
  double (*value)(const StepRecord& record);
};

/// Returns the table. The order is that of RewardTerms.
std::span<const RewardTerm> reward_terms();
/// @throws ConfigError listing the known names
std::size_t find_reward_term(std::string_view name);

/// Holds one number per row of the table.
class RewardTerms {
 public:
  static std::size_t size() noexcept;  ///< rows of the table
  double& operator[](std::size_t term) noexcept { return values_[term]; }
  double operator[](std::size_t term) const noexcept { return values_[term]; }
  double* begin() noexcept { return values_.data(); }
  double* end() noexcept { return values_.data() + size(); }
  const double* begin() const noexcept { return values_.data(); }
  const double* end() const noexcept { return values_.data() + size(); }
  void fill(double value) noexcept { std::fill(begin(), end(), value); }
  bool operator==(const RewardTerms& other) const = default;

  static constexpr std::size_t kMost = 64;  ///< rows that there is room for

 private:
  std::array<double, kMost> values_{};
};

/// Returns the guide's reward: 2000 vx, -2 |vy|, ...
RewardTerms guide_reward_weights();

/// Writes weight times value of every term with a weight, zero for the others. @returns their sum
double evaluate_reward(const StepRecord& record, const RewardTerms& weights, RewardTerms& terms) noexcept;

}  // namespace crossgait
