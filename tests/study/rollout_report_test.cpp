// What people and programs are told of rollouts and transfers, word for word, from numbers made by hand.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "study/rollout.h"
#include "tests/support/table_rows.h"

namespace crossgait {
namespace {

using M = MotionSummary;
using Rows = std::vector<Cells>;
using nlohmann::ordered_json;

std::size_t& outcomes_of(Evaluation& e, Outcome outcome) {
  return e.outcomes[static_cast<std::size_t>(outcome)];
}

// Every number another one, so that none can be shown for another.
Evaluation some_evaluation() {
  Evaluation e;
  e.episodes = 3;
  outcomes_of(e, Outcome::kWalked) = 2;
  outcomes_of(e, Outcome::kFell) = 1;
  e.total_reward = {1234.5, 6.25};
  e.reward_terms[find_reward_term("forward_velocity")] = 1200.5;
  e.reward_terms[find_reward_term("alive")] = 34;
  e.motion.of(&M::mean_speed_mps) = {0.1234, 0.0056};
  e.motion.of(&M::distance_m) = {0.617, 0.028};
  e.motion.of(&M::path_m) = {0.75, 0.05};
  e.motion.of(&M::rms_roll_deg) = {1.25, 0.1};
  e.motion.of(&M::rms_pitch_deg) = {2.75, 0.2};
  e.motion.of(&M::slip_m) = {0.375, 0.3};
  e.motion.of(&M::duty_factor) = {0.625, 0.4};
  e.motion.of(&M::cost_of_transport) = MeanAndDeviation{3.5, 0.75};
  e.motion.of(&M::swing_contact_ratio) = MeanAndDeviation{0.015, 0.005};
  e.motion.of(&M::slip_per_path) = MeanAndDeviation{0.25, 0.125};
  e.motion.of(&M::heading_error_deg) = MeanAndDeviation{4.5, 1.5};
  e.simulated_seconds = 12.5;
  e.steps = 6250;
  e.motion.of(&M::ik_clamped) = 7;
  e.invalid_actions = 8;
  e.clipped_actions = {{"joint.a", "joint.b"}, {1, 3}, 8};
  return e;
}

Evaluation walks_at(double speed) {
  Evaluation e;
  e.episodes = 1;
  outcomes_of(e, Outcome::kWalked) = 1;
  e.motion.of(&M::mean_speed_mps).mean = speed;
  return e;
}

Rollout some_rollout() {
  Rollout r;
  r.config.engine = "bullet";
  r.config.terrain = "rough";
  r.config.gait = "walk";
  r.config.reward.fill(0);
  r.config.reward[find_reward_term("forward_velocity")] = 2000;
  r.config.reward[find_reward_term("alive")] = 1;
  r.seed = 5;
  r.policies = {{"policies/fast.safetensors", {}, some_evaluation()}, {"zero", {}, walks_at(0.05)}};
  return r;
}

TEST(RolloutReport, TellsLargeRewardsByExponentsOfThousands) {
  Rollout rollout = some_rollout();
  rollout.policies[0].all.total_reward = {-4.2041e10, 1.2143e8};
  rollout.policies[1].all.total_reward = {12345, 9999.5};
  EXPECT_NE(describe(rollout).find("-42.041e9 +- 121.43e6"), std::string::npos) << describe(rollout);
  EXPECT_NE(describe(rollout).find("12.345e3 +- 9999.5"), std::string::npos);
}

TEST(RolloutReport, PutsPoliciesSideBySideWithTheTermsThatHaveAWeight) {
  EXPECT_EQ(table_rows(describe(some_rollout())),
            (Rows{{"On rough in bullet, fast.safetensors went 0.123 m/s (1 fell) and zero went 0.05 m/s (all "
                   "walked)."},
                  {"walk on rough in bullet, 3 episodes", "fast.safetensors", "zero"},
                  {"outcome", "1 fell", "all walked"},
                  {"simulated time, s", "12.5", "0.0"},
                  {"return per episode", "1234.5 +- 6.25", "0 +- 0"},
                  {"forward_velocity", "1200.5", "0"},
                  {"alive", "34", "0"},
                  {"distance, m", "0.617 +- 0.028", "0.000 +- 0.000"},
                  {"mean speed, m/s", "0.1234 +- 0.0056", "0.0500 +- 0.0000"},
                  {"RMS roll, deg", "1.25", "0.00"},
                  {"RMS pitch, deg", "2.75", "0.00"},
                  {"duty factor, mean of legs", "0.625", "0.000"},
                  {"swing contact, fraction", "0.015 +- 0.005", "-"},
                  {"swing contact, inner 80 %", "-", "-"},
                  {"slip over planned stance path", "0.250 +- 0.125", "-"},
                  {"heading error, deg", "4.50 +- 1.50", "-"},
                  {"slip of loaded feet, m", "0.38", "0.00"},  // 0.375 is a binary fraction: to even
                  {"cost of transport", "3.50 +- 0.75", "-"},
                  {"IK targets clamped", "7", "0"}}));
}

TEST(RolloutReport, OfOneEpisodeAndOfNone) {
  Rollout r = some_rollout();
  r.policies.erase(r.policies.begin());
  EXPECT_EQ(table_rows(describe(r)).at(1), (Cells{"walk on rough in bullet, 1 episode", "zero"}));
  r.policies.clear();  // interrupted before the first was finished
  EXPECT_EQ(summary(r), "No episode on rough in bullet.");
  EXPECT_EQ(table_rows(describe(r)).at(1), (Cells{"walk on rough in bullet, 0 episodes"}));
}

TEST(RolloutReport, AsJsonHasEveryNumber) {
  Evaluation e = some_evaluation();
  outcomes_of(e, Outcome::kLeftTerrain) = 4;
  outcomes_of(e, Outcome::kDiverged) = 5;
  const ordered_json json = to_json(e);
  const ordered_json expected = {
      {"episodes", 3},
      {"outcomes",
       {{"diverged", 5},
        {"loop_violated", 0},
        {"fell", 1},
        {"collapsed", 0},
        {"left_terrain", 4},
        {"slid", 0},
        {"no_progress", 0},
        {"backward", 0},
        {"strayed", 0},
        {"too_slow", 0},
        {"walked", 2}}},
      {"ended_early", 10},
      {"falls", 1},
      {"left_terrain", 4},
      {"diverged", 5},
      {"total_reward", {{"mean", 1234.5}, {"deviation", 6.25}}},
      {"reward_terms", {{"forward_velocity", 1200.5}, {"alive", 34.0}}},  // zeros are left out
      {"mean_speed_mps", {{"mean", 0.1234}, {"deviation", 0.0056}}},
      {"distance_m", {{"mean", 0.617}, {"deviation", 0.028}}},
      {"path_m", {{"mean", 0.75}, {"deviation", 0.05}}},
      {"rms_roll_deg", {{"mean", 1.25}, {"deviation", 0.1}}},
      {"rms_pitch_deg", {{"mean", 2.75}, {"deviation", 0.2}}},
      {"duty_factor", {{"mean", 0.625}, {"deviation", 0.4}}},
      {"swing_contact_ratio", {{"mean", 0.015}, {"deviation", 0.005}}},
      {"swing_contact_ratio_inner", nullptr},
      {"slip_per_path", {{"mean", 0.25}, {"deviation", 0.125}}},
      {"heading_error_deg", {{"mean", 4.5}, {"deviation", 1.5}}},
      {"slip_m", {{"mean", 0.375}, {"deviation", 0.3}}},
      {"cost_of_transport", {{"mean", 3.5}, {"deviation", 0.75}}},
      {"simulated_seconds", 12.5},
      {"steps", 6250},
      {"ik_clamped", 7},
      {"invalid_actions", 8},
      {"clipped_actions", {{"ratio", 0.25}, {"worst", "joint.b"}, {"worst_ratio", 0.375}}}};
  EXPECT_EQ(json.dump(1), expected.dump(1));
}

TEST(RolloutReport, AsJsonHasEveryPolicyAndEpisode) {
  Rollout r = some_rollout();
  EpisodeSummary episode;
  episode.seed = 11;
  episode.total_reward = 2.5;
  episode.reward_terms[find_reward_term("alive")] = 2.5;
  episode.steps = 9;
  episode.invalid_actions = 4;
  episode.motion.distance_m = 0.75;
  episode.parameters.emplace().step_length = 0.0625;
  r.policies[1].episodes = {episode, {}};
  const ordered_json json = to_json(r);
  EXPECT_EQ(json["schema"]["name"], "rollout");
  EXPECT_EQ(json["engine"], "bullet");
  EXPECT_EQ(json["terrain"], "rough");
  EXPECT_EQ(json["gait"], "walk");
  EXPECT_EQ(json["seed"], 5);
  EXPECT_FALSE(json.contains("interrupted"));
  ASSERT_EQ(json["policies"].size(), 2U);
  EXPECT_EQ(json["policies"][0]["policy"], "policies/fast.safetensors");
  EXPECT_EQ(json["policies"][0]["all"], to_json(some_evaluation()));
  ASSERT_EQ(json["policies"][1]["episodes"].size(), 2U);
  const ordered_json& one = json["policies"][1]["episodes"][0];
  EXPECT_EQ(one["seed"], 11);
  EXPECT_EQ(one["total_reward"], 2.5);
  EXPECT_EQ(one["reward_terms"], (ordered_json{{"alive", 2.5}}));
  EXPECT_EQ(one["steps"], 9);
  EXPECT_EQ(one["invalid_actions"], 4);
  EXPECT_EQ(one["clipped_actions"], (ordered_json{{"ratio", 0.0}, {"worst", nullptr}, {"worst_ratio", 0}}));
  EXPECT_EQ(one["distance_m"], 0.75);
  EXPECT_EQ(one["outcome"], "walked");
  EXPECT_EQ(one["parameters"].size(), gait_parameters().size());
  EXPECT_EQ(one["parameters"]["step_length"], 0.0625);
  const std::string note = json["notes"].at(0);
  EXPECT_TRUE(note.starts_with("fast.safetensors: 25 % of its actions are beyond")) << note;
  EXPECT_NE(note.find("(joint.b: in 38 % of the steps)"), std::string::npos) << note;
  r.policies[0].all.clipped_actions = {{"joint.a"}, {4}, 100};
  r.policies[1].all.clipped_actions = {};
  EXPECT_TRUE(to_json(r)["notes"].empty()) << "4 % is not told";
  r.interrupted = true;
  EXPECT_EQ(to_json(r)["interrupted"], true);
}

Transfer some_transfer() {
  Transfer t;
  t.policy = "policies/fast.safetensors";
  t.seed = 6;
  t.engines = {"mujoco", "bullet"};
  t.terrains = {"flat", "rough"};
  Evaluation fallen = walks_at(0.25);
  fallen.outcomes = {};
  outcomes_of(fallen, Outcome::kFell) = 1;
  t.cells = {{"flat", "mujoco", walks_at(0.2), walks_at(0.1)},
             {"flat", "bullet", fallen, walks_at(0.125)},
             {"rough", "mujoco", walks_at(0.16), walks_at(-0.01)}};  // and there it was interrupted
  return t;
}

TEST(TransferReport, PutsEnginesSideBySideAndSaysHowFarTheyAreApart) {
  EXPECT_EQ(table_rows(describe(some_transfer())),
            (Rows{{"mean speed, m/s", "policy", "mujoco", "bullet", "largest / smallest"},
                  {"flat", "fast.safetensors", "0.2000", "0.2500 (1 fell)", "1.250"},
                  {"flat", "zero", "0.1000", "0.1250", "1.250"},
                  {"rough", "fast.safetensors", "0.1600", "-", "1.000"},
                  {"rough", "zero", "-0.0100", "-", "-"}}));  // no ratio of speeds backwards
}

TEST(TransferReport, OfNoPolicyHasItOnce) {
  Transfer t = some_transfer();
  t.policy = "zero";
  t.terrains = {"rough", "waves"};
  EXPECT_EQ(table_rows(describe(t)),
            (Rows{{"mean speed, m/s", "policy", "mujoco", "bullet", "largest / smallest"},
                  {"rough", "zero", "0.1600", "-", "1.000"},
                  {"waves", "zero", "-", "-", "-"}}));
}

TEST(TransferReport, AsJsonHasEveryCell) {
  Transfer t = some_transfer();
  const ordered_json json = to_json(t);
  EXPECT_EQ(json["schema"]["name"], "transfer");
  EXPECT_EQ(json["policy"], "policies/fast.safetensors");
  EXPECT_EQ(json["seed"], 6);
  EXPECT_FALSE(json.contains("interrupted"));
  ASSERT_EQ(json["cells"].size(), 3U);
  EXPECT_EQ(json["cells"][1], (ordered_json{{"terrain", "flat"},
                                            {"engine", "bullet"},
                                            {"policy", to_json(t.cells[1].policy)},
                                            {"baseline", to_json(t.cells[1].baseline)}}));
  t.interrupted = true;
  EXPECT_EQ(to_json(t)["interrupted"], true);
}

}  // namespace
}  // namespace crossgait
