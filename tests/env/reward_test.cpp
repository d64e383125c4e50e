#include "env/reward.h"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "physics/core/error.h"
#include "scenes/robots.h"

namespace crossgait {
namespace {

TEST(Reward, EveryTermIsItsFormula) {
  const auto robot = scenes::quadruped();
  const std::vector<int> servos = robot->actuated_joints();
  RobotState before, after;
  before.q = after.q = robot->home;
  before.qd = JointVector::Zero(robot->joint_count());
  after.qd = before.qd;
  after.qd[servos[0]] = 0.3;
  after.qd[servos[5]] = -0.4;
  after.p_WB = before.p_WB + Vector3(0.003, -0.004, 0.1);
  after.v_WB = {0.12, -0.05, 0.02};
  after.w_WB = {0.3, -0.4, 0.6};
  after.q_WB = from_roll_pitch_yaw(0.1, 0.2, 0.3);
  LegArray<FootContact> contacts{};
  contacts[Leg::FL].touching = true;
  contacts[Leg::FR].touching = true;
  LegArray<bool> swing{};
  swing[Leg::FR] = true;  // FL right, FR wrong, RL should touch and does not, RR likewise
  const std::vector<double> action{0.5, -1}, last_action{0, 1}, parameters{0.05, 0.8}, last{0.04, 0.9};
  const StepRecord record{
      .dt = 0.02,
      .before = before,
      .after = after,
      .v_start = {0.11, -0.06, 0.02},
      .v_heading = {0.13, 0.04, 0.02},
      .roll_pitch_yaw = {0.1, 0.2, 0.3},
      .height = 0.05,
      .standing_height = 0.07,
      .command = {0.1, 0.01, 0.5},
      .contacts = contacts,
      .swing = swing,
      .action = action,
      .last_action = last_action,
      .parameters = parameters,
      .last_parameters = last,
      .servos = servos,
      .weight = 10,
      .during = {.seconds = 0.01, .work = 0.0023, .torque_squares = 0.0029, .slip_squares = 0.0005},
      .terminated = true};
  const double degrees = 180 / M_PI;
  const std::map<std::string, double> expected{
      {"forward_velocity", 0.11},
      {"lateral_velocity", 0.06},
      {"contact_pattern", 0.2 - 0.5 - 0.5 - 0.5},
      {"orientation_l2", degrees * degrees * (0.01 + 0.04 + 0.09)},
      {"joint_acc_l2", 15 * 15 + 20 * 20},  // 0.3 and 0.4 rad/s in 0.02 s
      {"parameter_rate_l2", 0.01 * 0.01 + 0.1 * 0.1},
      {"velocity_tracking", std::exp(-(0.03 * 0.03 + 0.03 * 0.03) / 0.01)},
      {"velocity_error", std::hypot(0.03, 0.03)},
      {"forward_velocity_ratio", 1},  // faster than asked for
      {"yaw_rate_tracking", std::exp(-0.04)},
      {"yaw_rate_error", 0.1},
      {"vertical_velocity", 0.0004},
      {"tilt_rate", 0.25},
      {"flat_orientation_l2", 1 - std::pow(std::cos(0.1) * std::cos(0.2), 2)},
      {"base_height_l2", 0.0004},
      {"alive", 1},
      {"termination", 1},
      {"action_rate_l2", 0.25 + 4},
      {"action_l2", 1.25},
      {"foot_slip", 0.05},
      {"joint_torques_l2", 0.29},
      {"power", 0.23},
      {"cost_of_transport", 0.0023 / (10 * 0.005)},
  };
  ASSERT_EQ(expected.size(), reward_terms().size());
  for (const RewardTerm& term : reward_terms())
    EXPECT_NEAR(term.value(record), expected.at(std::string(term.name)), 1e-12) << term.name;  // rounding

  RewardTerms weights{}, terms{};
  weights.fill(-0.5);
  double sum = 0;
  for (const auto& [name, value] : expected) sum -= value / 2;
  EXPECT_NEAR(evaluate_reward(record, weights, terms), sum, 1e-9);
  for (std::size_t i = 0; i < terms.size(); ++i)
    EXPECT_NEAR(terms[i], -0.5 * expected.at(std::string(reward_terms()[i].name)), 1e-9);
  weights.fill(0);
  EXPECT_EQ(evaluate_reward(record, weights, terms), 0);
  EXPECT_EQ(terms, RewardTerms{});
}

TEST(Reward, TermsSayWhatTheyAre) {
  for (const RewardTerm& term : reward_terms()) EXPECT_FALSE(term.help.empty()) << term.name;
}

TEST(Reward, TheGuidesWeights) {
  const RewardTerms weights = guide_reward_weights();
  const std::map<std::string, double> guide{{"forward_velocity", 2000}, {"lateral_velocity", -2},
                                            {"contact_pattern", 1},     {"orientation_l2", -2},
                                            {"joint_acc_l2", -0.1},     {"parameter_rate_l2", -5}};
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const auto it = guide.find(std::string(reward_terms()[i].name));
    EXPECT_EQ(weights[i], it == guide.end() ? 0 : it->second) << reward_terms()[i].name;
  }
  EXPECT_THROW((void)find_reward_term("fun"), ConfigError);
}

TEST(Reward, ARobotAtRestHasAFiniteCostOfTransport) {
  const auto robot = scenes::quadruped();
  RobotState state;
  state.q = robot->home;
  state.qd = JointVector::Zero(robot->joint_count());
  const LegArray<FootContact> contacts{};
  const StepRecord record{.dt = 0.02,
                          .before = state,
                          .after = state,
                          .v_start = Vector3::Zero(),
                          .v_heading = Vector3::Zero(),
                          .roll_pitch_yaw = Vector3::Zero(),
                          .height = 0,
                          .standing_height = 0,
                          .command = {},
                          .contacts = contacts,
                          .swing = {},
                          .action = {},
                          .last_action = {},
                          .parameters = {},
                          .last_parameters = {},
                          .servos = {},
                          .weight = 10,
                          .during = {},
                          .terminated = false};
  for (const RewardTerm& term : reward_terms()) EXPECT_TRUE(std::isfinite(term.value(record))) << term.name;
}

}  // namespace
}  // namespace crossgait
