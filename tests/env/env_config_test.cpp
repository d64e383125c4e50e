#include "crossgait/env/env_config.h"

#include <gtest/gtest.h>

#include "crossgait/physics/error.h"

namespace crossgait {
namespace {

/// The message of the error that reading `text` gives; empty if it gives none.
std::string complaint(const std::string& text) {
  try {
    static_cast<void>(parse_env_config(text, "env.yaml"));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

TEST(EnvConfig, AnEmptyFileIsTheDefault) {
  EXPECT_EQ(to_yaml(parse_env_config("{}", "empty")), to_yaml(EnvConfig{}));
}

TEST(EnvConfig, ReadsBackWhatItWrites) {
  EnvConfig c;
  c.engine = "bullet";
  c.terrain = "rough:amplitude=.01";
  c.terrain_seed = 7;
  c.gait = "walk";
  c.parameters = find_gait("walk").preferred;
  c.parameters.step_length = 0.1 / 3;
  c.parameters.swing = SwingCurve::kMatched;
  c.adapt = {"step_length", "stance_width"};
  c.residual_scale = 0.02;
  c.command = VelocityCommand{0.1, -0.02, 0.3};
  c.observation = {"joint_positions", "terrain"};
  c.reward.fill(0);
  c.reward[find_reward_term("alive")] = 0.25;
  c.policy_dt = 0.02;
  c.ends = OutcomeSet().add(Outcome::kDiverged).add(Outcome::kCollapsed);
  c.randomisation[Randomised::kFriction] = {0.5, 1.5};
  const EnvConfig back = parse_env_config(to_yaml(c), "round trip");
  EXPECT_EQ(to_yaml(back), to_yaml(c));
  EXPECT_EQ(back.parameters.step_length, c.parameters.step_length);  // every digit
  EXPECT_EQ(back.reward, c.reward);
  EXPECT_EQ(back.ends, c.ends);
  EXPECT_EQ(back.randomisation.ranges, c.randomisation.ranges);
}

TEST(EnvConfig, TheEngineMayGoByItsOldKey) {
  EXPECT_EQ(parse_env_config("backend: bullet\n", "env.yaml").engine, "bullet");
  EXPECT_EQ(parse_env_config("engine: bullet\n", "env.yaml").engine, "bullet");
}

TEST(EnvConfig, DivergenceEndsAnEpisodeWhateverIsAskedFor) {
  const OutcomeSet ends = parse_env_config("ends: [fell]\n", "env.yaml").ends;
  EXPECT_EQ(ends, OutcomeSet().add(Outcome::kFell).add(Outcome::kDiverged));
  EXPECT_EQ(parse_env_config("ends: []\n", "env.yaml").ends, OutcomeSet().add(Outcome::kDiverged));
  EXPECT_EQ(parse_env_config("{}", "env.yaml").ends, OutcomeSet::of_episodes());
}

TEST(EnvConfig, AGaitBringsItsPreferredParameters) {
  const EnvConfig c = parse_env_config("gait: gallop\nparameters: {step_length: .07}\n", "env.yaml");
  EXPECT_EQ(c.parameters.cycle_time, find_gait("gallop").preferred.cycle_time);
  EXPECT_EQ(c.parameters.step_length, 0.07);
}

TEST(EnvConfig, AGivenRewardIsTheWholeReward) {
  const EnvConfig c = parse_env_config("reward: {alive: 1}\n", "env.yaml");
  RewardTerms expected{};
  expected[find_reward_term("alive")] = 1;
  EXPECT_EQ(c.reward, expected);
}

TEST(EnvConfig, ErrorsNameTheLineTheExpectedAndTheFound) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases{
      {"gait: trot\ngiat: walk\n", {"env.yaml", "line 2", "giat"}},
      {"\ngait: amble\n", {"line 2, gait", "trot", "amble"}},
      {"parameters: {step_size: 1}\n", {"line 1", "step_height", "step_size"}},
      {"parameters: {step_height: 1}\n", {"parameters.step_height", "0.03", "1"}},
      {"adapt: [step_height, girth]\n", {"adapt", "girth"}},
      {"observation: [smell]\n", {"base_position", "smell"}},
      {"observation: [phase, phase]\n", {"every block once", "phase twice"}},
      {"observation: []\n", {"observation"}},
      {"reward: {fun: 1}\n", {"reward.fun", "forward_velocity"}},
      {"reward: {alive: .nan}\n", {"reward.alive", "finite"}},
      {"physics_dt: 0\n", {"physics_dt", "(0, .1]"}},
      {"control_dt: .0015\n", {"control_dt", "multiple of 0.001 s"}},
      {"policy_dt: .003\n", {"policy_dt", "multiple of 0.002 s"}},
      {"episode_seconds: -1\n", {"episode_seconds"}},
      {"friction: -1\n", {"friction"}},
      {"terrain_seed: -1\n", {"terrain_seed"}},
      {"randomisation: {wind: [0, 1]}\n", {"randomisation.wind", "friction"}},
      {"randomisation: {friction: [2, 1]}\n", {"friction", "[2, 1]"}},
      {"randomisation: {friction: 1}\n", {"randomisation.friction"}},
      {"randomisation: {push_impulse: [0, 1]}\n", {"push_interval"}},
      {"command: {vz: 1}\n", {"command", "vz"}},
      {"ends: [fell, stumbled]\n", {"ends", "came_apart", "stumbled"}},
      {"ends: [slid]\n", {"ends", "the moment", "slid"}},
      {"ends: fell\n", {"ends"}},
  };
  for (const auto& [text, words] : cases) {
    const std::string message = complaint(text);
    for (const std::string& word : words)
      EXPECT_NE(message.find(word), std::string::npos) << text << " said: " << message;
  }
}

}  // namespace
}  // namespace crossgait
