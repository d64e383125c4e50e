#include "env/env_config.h"

#include <filesystem>
#include <functional>

#include <gtest/gtest.h>

#include "env/env_model.h"
#include "physics/core/error.h"
#include "tests/physics/core/kept_inputs.h"

namespace crossgait {
namespace {

/// Reads an environment, and keeps what it was read of.
EnvConfig parsed(const std::string& text, const std::string& source = "env.yaml") {
  keep_input("env.yaml", text);
  return parse_env_config(text, source);
}

/// The message of the error that reading `text` gives; empty if it gives none.
std::string complaint(const std::string& text) {
  try {
    static_cast<void>(parsed(text, "env.yaml"));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

TEST(EnvConfig, AnEmptyFileIsTheDefault) { EXPECT_EQ(to_yaml(parsed("{}", "empty")), to_yaml(EnvConfig{})); }

TEST(EnvConfig, ReadsBackWhatItWrites) {
  EnvConfig c;
  c.engine = "bullet";
  c.terrain = "rough:amplitude=.01";
  c.terrain_seed = 7;
  c.gait = "walk";
  c.parameters = GaitSettings::all(find_gait("walk").preferred);
  c.parameters["step_length"] = 0.1 / 3;
  c.parameters.swing = SwingCurve::kMatched;
  c.adapt = {"step_length", "stance_width"};
  c.residual_scale = 0.02;
  c.command = VelocityCommand{0.1, -0.02, 0.3};
  c.observation = {"joint_positions", "terrain"};
  c.reward.fill(0);
  c.reward[find_reward_term("alive")] = 0.25;
  c.robot = "scara_quadruped_long";
  c.contact = parse_contact_settings("friction=0.375,impratio=100,cone=pyramidal,solref=0.005:1", "test");
  c.physics_dt = 5e-4;
  c.control_dt = 4e-3;
  c.policy_dt = 0.02;
  c.episode_seconds = 7;
  c.settle_seconds = 0.25;
  c.tilt_limit_deg = 45;
  c.terminations = OutcomeSet().add(Outcome::kDiverged).add(Outcome::kCollapsed);
  c.randomisation[Randomised::kFriction] = {0.5, 1.5};
  const EnvConfig back = parsed(to_yaml(c), "round trip");
  EXPECT_EQ(to_yaml(back), to_yaml(c));
  for (double EnvConfig::*number :
       {&EnvConfig::physics_dt, &EnvConfig::control_dt, &EnvConfig::policy_dt, &EnvConfig::episode_seconds,
        &EnvConfig::settle_seconds, &EnvConfig::tilt_limit_deg})
    EXPECT_EQ(back.*number, c.*number);
  EXPECT_EQ(back.contact.said, c.contact.said);
  EXPECT_EQ(back.residual_scale, c.residual_scale);
  EXPECT_EQ(back.engine, c.engine);
  EXPECT_EQ(back.robot, c.robot);
  EXPECT_EQ(back.terrain, c.terrain);
  EXPECT_EQ(back.terrain_seed, c.terrain_seed);
  EXPECT_EQ(back.gait, c.gait);
  EXPECT_EQ(back.parameters.swing, c.parameters.swing);
  EXPECT_EQ(back.adapt, c.adapt);
  EXPECT_EQ(back.command->yaw_rate, c.command->yaw_rate);
  EXPECT_EQ(back.observation, c.observation);
  EXPECT_EQ(back.parameters, c.parameters);  // every digit
  EXPECT_EQ(back.reward, c.reward);
  EXPECT_EQ(back.terminations, c.terminations);
  EXPECT_EQ(back.randomisation.ranges, c.randomisation.ranges);
}

TEST(EnvConfig, ReadsBackJointActions) {
  EnvConfig c = joint_environment();
  c.robot = "serial_quadruped";
  c.joints.order = {"b: c", "a"};  // names as a URDF may have them
  c.joints.home.by_name = {{"a", 0.1 / 3}};
  c.joints.scale = {0.25, {{"b: c", 0.5}}};
  c.joints.limit = 10;
  c.joints.delay = 4e-3;
  c.servos["kp"].all = 35;
  c.servos["friction"] = {0.3, {{"a", 1}}};
  c.observation[2].scale = {1, 2, 0.1 / 3};
  c.observation[3].clip = 5;
  c.observation[4].noise = 0.01;
  c.observation[5].delay = 0.02;
  c.observation[6].history = 4;
  const EnvConfig back = parsed(to_yaml(c), "round trip");
  EXPECT_EQ(to_yaml(back), to_yaml(c));
  EXPECT_EQ(back.action, ActionKind::kJoints);
  EXPECT_EQ(back.joints, c.joints);
  EXPECT_EQ(back.servos, c.servos);
  EXPECT_EQ(back.observation, c.observation);
}

TEST(EnvConfig, ActionJointsBeginsWithWhatJointPoliciesUse) {
  EXPECT_EQ(to_yaml(parsed("action: joints\n", "env.yaml")), to_yaml(joint_environment()));
  EXPECT_EQ(to_yaml(parsed("action: gait\n", "env.yaml")), to_yaml(EnvConfig()));
  EXPECT_EQ(EnvModel::make(joint_environment())->interface.observation.size(), 48U);
}

// What docs/environment.md says, written out.
TEST(EnvConfig, ActionJointsEarnsWhatTheGuideToItSays) {
  EXPECT_EQ(to_yaml(parsed("action: joints\n", "env.yaml")),
            to_yaml(parsed("action: joints\n"
                           "joints: {scale: 0.5, limit: 1, delay: 0}\n"
                           "command: {vx: 0.3, vy: 0, yaw_rate: 0}\n"
                           "observation: [base_linear_velocity_local, base_angular_velocity_local, gravity, "
                           "joint_offsets, joint_velocities, last_action, command]\n"
                           "policy_dt: 0.02\n"
                           "reward: {velocity_tracking: 1, yaw_rate_tracking: .3, flat_orientation_l2: -2, "
                           "action_rate_l2: -.01, "
                           "foot_slip: -1, termination: -10}\n",
                           "env.yaml")));
}

TEST(EnvConfig, KeysOfOneKindOfActionAreErrorsWithTheOther) {
  EXPECT_EQ(complaint("action: joints\ngait: walk\n"),
            "env.yaml: line 2, gait: expected this key with action: gait alone, found action: joints");
  EXPECT_EQ(complaint("joints: {limit: 2}\n"),
            "env.yaml: line 1, joints: expected this key with action: joints alone, found action: gait");
  EXPECT_EQ(complaint("action: wings\n"), "env.yaml: line 1, action: expected gait or joints, found 'wings'");
  EXPECT_EQ(complaint("preset: guide\naction: joints\n"),
            "env.yaml: line 2, action: expected gait, which the guide's actions adapt, found joints");
  EXPECT_EQ(complaint("action: joints\njoints: {gain: 2}\n"),
            "env.yaml: line 2, joints.gain: expected one of the keys order, observed, command, home, offset, "
            "scale, lower, upper, limit, delay, filter, actuator, found unknown key 'gain'");
  EXPECT_EQ(
      complaint("servos: {ki: 2}\n"),
      "env.yaml: line 1, servos.ki: expected one of the keys kp, kd, effort, effort_negative, "
      "implicit_stiffness, implicit_damping, damping, implicit_joint_damping, stiffness, armature, friction, "
      "corner_speed, "
      "no_load_speed, backlash, delay, lag, sensor_noise, law, found unknown key 'ki' (did you mean kp?)");
  EXPECT_EQ(complaint("observation: [{block: gravity, gain: 2}]\n"),
            "env.yaml: line 1, observation[0].gain: expected one of the keys block, scale, clip, "
            "clip_unscaled, noise, "
            "delay, history, found unknown key 'gain'");
  EXPECT_EQ(complaint("observation: [{block: gravity, scale: fast}]\n"),
            "env.yaml: line 1, observation[0].scale: expected a finite number, found 'fast'");
}

TEST(EnvConfig, AServoLawIsItsTwoNumbers) {
  const auto servos = [](const std::string& text) {
    return parsed("servos: {" + text + "}\n", "env.yaml").servos;
  };
  EXPECT_EQ(servos("law: drive"), servos("implicit_stiffness: 1, implicit_damping: 1"));
  EXPECT_EQ(servos("law: damping"), servos("implicit_stiffness: 0, implicit_damping: 1"));
  EXPECT_EQ(servos("law: {all: explicit, FL_knee: drive}"),
            servos("implicit_stiffness: {all: 0, FL_knee: 1}, implicit_damping: {all: 0, FL_knee: 1}"));
  EXPECT_EQ(
      complaint("servos: {law: drives}\n"),
      "env.yaml: servo law: expected one of explicit, damping, drive, found 'drives' (did you mean drive?)");
  EXPECT_EQ(complaint("servos: {law: drive, implicit_damping: 0}\n"),
            "env.yaml: line 1, servos.implicit_damping: expected either a law or its numbers, found both");
}

TEST(EnvConfig, WhatComesOnTopReplacesKeyByKey) {
  const EnvConfig base = parsed(
      "robot: serial_quadruped\naction: joints\njoints: {scale: .3, limit: 2}\nreward: {termination: -1}\n",
      "env.yaml");
  EnvConfig expected = base;
  expected.terrain = "rough";
  expected.joints.limit = 1;
  EXPECT_EQ(to_yaml(override_env_config(base, "{terrain: rough, joints: {limit: 1}}", "keywords")),
            to_yaml(expected));
  EXPECT_EQ(to_yaml(override_env_config(base, "{}", "keywords")), to_yaml(base));
  const auto complaint_on_top = [&base](const char* text) -> std::string {
    try {
      static_cast<void>(override_env_config(base, text, "keywords"));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(complaint_on_top("action: joints"),
            "keywords: line 1, action: expected no such key on top of another configuration, found joints");
  EXPECT_EQ(complaint_on_top("gait: walk"),
            "keywords: line 1, gait: expected this key with action: gait alone, found action: joints");
  EXPECT_EQ(complaint_on_top("physics_dt: -1"),
            "keywords: line 1, physics_dt: expected a time step in [1e-06, 0.1] s, found -1");
  EXPECT_NE(complaint_on_top("terrane: flat").find("unknown key 'terrane'"), std::string::npos);
}

TEST(EnvConfig, TheEngineMayGoByItsOldKey) {
  EXPECT_EQ(parsed("engine: bullet\n", "env.yaml").engine, "bullet");
  EXPECT_EQ(parsed("engine: bullet\n", "env.yaml").engine, "bullet");
}

TEST(EnvConfig, DivergenceEndsAnEpisodeWhateverIsAskedFor) {
  const OutcomeSet terminations = parsed("terminations: [fell]\n", "env.yaml").terminations;
  EXPECT_EQ(terminations, OutcomeSet().add(Outcome::kFell).add(Outcome::kDiverged));
  EXPECT_EQ(parsed("terminations: []\n", "env.yaml").terminations, OutcomeSet().add(Outcome::kDiverged));
  EXPECT_EQ(parsed("{}", "env.yaml").terminations, OutcomeSet::of_episodes());
}

TEST(EnvConfig, AGaitBringsItsPreferredParameters) {
  const EnvConfig c = parsed("gait: gallop\nparameters: {step_length: .07}\n", "env.yaml");
  const GaitParameters p = EnvModel::make(c)->parameters;
  EXPECT_EQ(p.cycle_time, find_gait("gallop").preferred.cycle_time);
  EXPECT_EQ(p.step_length, 0.07);
}

TEST(EnvConfig, ThePresetOfTheGuideIsABeginning) {
  const EnvConfig guide = parsed("preset: guide\n", "env.yaml");
  EXPECT_EQ(to_yaml(guide), to_yaml(guide_environment()));
  EXPECT_EQ(guide.gait, "trot:guide");
  const GaitParameters of_guide = EnvModel::make(guide)->parameters;
  EXPECT_EQ(of_guide.cycle_time, 0.8);
  EXPECT_EQ(guide.adaptation, guide_ranges());
  const EnvConfig changed =
      parsed("parameters: {step_length: .05}\npreset: guide\nheading_hold: false\n", "env.yaml");
  const GaitParameters p = EnvModel::make(changed)->parameters;
  EXPECT_EQ(p.step_length, 0.05);
  EXPECT_EQ(p.body_height, of_guide.body_height);
  EXPECT_TRUE(guide.heading_hold);
  EXPECT_FALSE(changed.heading_hold);
  EXPECT_FALSE(parsed(to_yaml(changed), "env.yaml").heading_hold);
  EXPECT_EQ(parsed(to_yaml(guide), "env.yaml").adaptation, guide_ranges());
}

TEST(EnvConfig, AGivenRewardIsTheWholeReward) {
  const EnvConfig c = parsed("reward: {alive: 1}\n", "env.yaml");
  RewardTerms expected{};
  expected[find_reward_term("alive")] = 1;
  EXPECT_EQ(c.reward, expected);
}

TEST(EnvConfig, ErrorsNameTheLineTheExpectedAndTheFound) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases{
      {"gait: trot\ngiat: walk\n", {"env.yaml", "line 2", "giat"}},
      {"\ngait: stroll\n", {"line 2, gait", "trot", "stroll"}},
      {"gait: trot\npreset: book\n", {"line 2, preset", "guide", "book"}},
      {"heading_hold: 1.5\n", {"line 1, heading_hold", "1.5"}},
      {"parameters: {step_size: 1}\n", {"line 1", "step_height", "step_size"}},
      {"parameters: {step_height: -1}\n", {"parameters.step_height", "0 to 1000 m", "-1"}},
      {"adapt: [step_height, step_height]\n", {"line 1, adapt", "step_height twice"}},
      {"ranges: {cycle_time: [.8, .15]}\n", {"line 1, ranges.cycle_time", "min < max", "[0.8, 0.15]"}},
      {"ranges: {girth: [0, 1]}\n", {"line 1, ranges.girth", "cycle_time"}},
      {"ranges: {cycle_time: .5}\n", {"line 1, ranges.cycle_time", "a list"}},
      {"delta_scales: {cycle_time: 0}\n", {"line 1, delta_scales.cycle_time", "above 0"}},
      {"physics_dt: 1e-12\n", {"env.yaml: line 1, physics_dt", "[1e-06, 0.1] s"}},
      {"residual_scale: 1e6\n", {"line 1, residual_scale", "[0, 1] m"}},
      {"friction: 1e9\n", {"line 1, friction", "[0, 10]"}},
      {"policy_dt: 1e-5\ncontrol_dt: 1e-5\nphysics_dt: 1e-5\nepisode_seconds: 1e5\n",
       {"line 4, episode_seconds", "1e+09 policy steps"}},
      {"episode_seconds: 1e6\nphysics_dt: 1e-4\n", {"line 2, physics_dt", "2^31"}},
      {"adapt: [step_height, girth]\n", {"adapt", "girth"}},
      {"observation: [smell]\n", {"base_position", "smell"}},
      {"observation: [phase, phase]\n", {"every block once", "phase twice"}},
      {"observation: []\n", {"observation"}},
      {"reward: {fun: 1}\n", {"reward.fun", "forward_velocity"}},
      {"reward: {alive: .nan}\n", {"reward.alive", "finite"}},
      {"physics_dt: 0\n", {"physics_dt", "0.1] s"}},
      {"control_dt: .0015\n", {"control_dt", "multiple of 0.001 s"}},
      {"policy_dt: .003\n", {"policy_dt", "multiple of 0.002 s"}},
      {"policy_dt: 1e300\n", {"policy_dt", "at most 100000 physics steps"}},
      {"settle_seconds: 200\n", {"settle_seconds", "at most 100000 physics steps"}},
      {"episode_seconds: -1\n", {"episode_seconds"}},
      {"friction: -1\n", {"friction"}},
      {"terrain_seed: -1\n", {"terrain_seed"}},
      {"randomisation: {wind: [0, 1]}\n", {"randomisation.wind", "friction"}},
      {"randomisation: {friction: [2, 1]}\n", {"env.yaml: line 1, randomisation.friction", "[2, 1]"}},
      {"randomisation:\n  mass: [.9, 1.1]\n  friction: [0, 11]\n",
       {"env.yaml: line 3, randomisation.friction", "[0, 10] x"}},
      {"randomisation: {friction: 1}\n", {"randomisation.friction"}},
      {"randomisation: {push_impulse: [0, 1]}\n", {"push_interval"}},
      {"randomisation: {push_interval: [1, 2]}\n", {"env.yaml: push_impulse"}},
      {"command: {vz: 1}\n", {"command", "vz"}},
      {"terminations: [fell, stumbled]\n", {"terminations", "loop_violated", "stumbled"}},
      {"terminations: [slid]\n", {"terminations", "the moment", "slid"}},
      {"terminations: fell\n", {"terminations"}},
  };
  for (const auto& [text, words] : cases) {
    const std::string message = complaint(text);
    for (const std::string& word : words)
      EXPECT_NE(message.find(word), std::string::npos) << text << " said: " << message;
  }
}

TEST(EnvConfig, ReadsBackSeedsAndNamesOfEveryKind) {
  EnvConfig c;
  c.terrain_seed = 18446744073709551615U;
  for (const std::string name : {"it's", "a\"b\"", "back\\slash", "two\nlines", "# a: [b", " c ", "\x01"}) {
    c.robot = "/models/" + name + ".yaml";
    c.terrain = "/models/" + name + ".png:z_max=1";
    c.engine = name;
    const EnvConfig back = parsed(to_yaml(c), "round trip");
    EXPECT_EQ(back.robot, c.robot);
    EXPECT_EQ(back.terrain, c.terrain);
    EXPECT_EQ(back.engine, c.engine);
    EXPECT_EQ(back.terrain_seed, c.terrain_seed);
  }
}

TEST(EnvConfig, ReadsBackItsRanges) {
  EnvConfig c;
  c.adaptation.ranges["cycle_time"] = {0.15, 0.8};
  c.adaptation.ranges["step_length"] = {0.01, 0.1 / 3};
  c.adaptation.delta_scales["cycle_time"] = 0.02;
  EXPECT_EQ(parsed(to_yaml(c), "round trip").adaptation, c.adaptation);
  EXPECT_EQ(to_yaml(EnvConfig{}).find("ranges"), std::string::npos);
}

TEST(EnvConfig, FindsFilesFromItsOwnFolder) {
  const EnvConfig c = parsed("robot: my/robot.yaml\nterrain: ../maps/hill.png:z_max=1\n", "lab/env/e.yaml");
  EXPECT_EQ(c.robot, "lab/env/my/robot.yaml");
  EXPECT_EQ(c.terrain, "lab/maps/hill.png:z_max=1");
  const EnvConfig named = parsed("robot: scara_quadruped_long\nterrain: rough:seed=3\n", "lab/e.yaml");
  EXPECT_EQ(named.robot, "scara_quadruped_long");
  EXPECT_EQ(named.terrain, "rough:seed=3");
  EXPECT_EQ(parsed("terrain: /maps/hill.csv\n", "lab/e.yaml").terrain, "/maps/hill.csv");
  // Written with the whole path, it may be kept anywhere.
  const std::filesystem::path whole = parsed(to_yaml(c), "elsewhere/e.yaml").robot;
  EXPECT_EQ(whole, std::filesystem::current_path() / "lab/env/my/robot.yaml");
}

TEST(EnvConfig, WhatIsWrongWithAFileThatItNamesIsSaidAtItsLine) {
  const auto element = [](const std::string& text, const std::function<void(EnvConfig&)>& change = {}) {
    EnvConfig c = parsed(text, "lab/e.yaml");
    if (change) change(c);
    try {
      static_cast<void>(EnvModel::make(c));
    } catch (const ConfigError& error) {
      return error.source() + ": " + error.element();
    }
    return std::string("none");
  };
  EXPECT_EQ(element("gait: trot\nterrain: rogh\n"), "lab/e.yaml: line 2, terrain: terrain 'rogh': name");
  EXPECT_EQ(element("terrain: hill.png\n"), "lab/e.yaml: line 1, terrain: lab/hill.png: file");
  EXPECT_EQ(element("robot: no.yaml\n"), "lab/e.yaml: line 1, robot: lab/no.yaml: file");
  EXPECT_EQ(element("robot: skara\n"), "lab/e.yaml: line 1, robot: robot: name");
  EXPECT_EQ(element("terrain: rough\n", [](EnvConfig& c) { c.terrain = "rogh"; }), "terrain 'rogh': name")
      << "the file did not say so";
}

TEST(EnvConfig, EnginesOfAnyNameReadBack) {
  for (char c = ' '; c <= '~'; ++c) {
    EnvConfig config;
    config.engine = std::string("a") + c + "b";
    EXPECT_EQ(parsed(to_yaml(config), "round trip").engine, config.engine);
    config.engine = std::string(1, c) + "b";
    EXPECT_EQ(parsed(to_yaml(config), "round trip").engine, config.engine);
  }
}

TEST(EnvConfig, RangesShowInTheLayoutAndItsHash) {
  EnvConfig plain, ranged;
  ranged.adaptation.ranges["cycle_time"] = {0.2, 1.2};
  ranged.adaptation.delta_scales["cycle_time"] = 0.02;
  ranged.parameters["cycle_time"] = 0.5;
  const auto a = EnvModel::make(plain), b = EnvModel::make(ranged);
  EXPECT_NE(a->layout, b->layout);
  EXPECT_EQ(b->interface.action.entries[2].unit, "0.02 s");
  EXPECT_EQ(b->interface.observation.entries[*b->interface.observation.find("param.cycle_time")].unit,
            "0.2 to 1.2 s");
  EnvConfig outside;
  outside.parameters["cycle_time"] = 1.125;
  const auto c = EnvModel::make(outside);
  EXPECT_EQ(a->layout, c->layout) << "the numbers mean the same";
  const auto entry = c->interface.observation.entries[*c->interface.observation.find("param.cycle_time")];
  EXPECT_NEAR(entry.max, 2, 1e-12);  // (1.125 - 0.475) / 0.325; rounding
}

}  // namespace
}  // namespace crossgait
