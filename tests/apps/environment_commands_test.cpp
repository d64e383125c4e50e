// env, rollout, transfer and tune from the command line.
#include <filesystem>
#include <fstream>
#include <set>

#include <gtest/gtest.h>

#include "backends/registry.h"
#include "env/env_config.h"
#include "tests/apps/run_program.h"

namespace crossgait {
namespace {

using nlohmann::json;

std::string engine_of_test() { return available_engines().front(); }

TEST(EnvCommand, DescribesEveryNumberByName) {
  const json result = run_json(
      "env --describe --adapt step_height,step_length,cycle_time,body_height,stance_width "
      "--observe terrain --engine " +
      engine_of_test());
  EXPECT_EQ(result["action_size"], 17);
  EXPECT_EQ(result["observation_size"], 78);
  EXPECT_EQ(result["action"].size(), 17U);
  EXPECT_EQ(result["observation"].size(), 78U);
  EXPECT_EQ(result["action"][4]["name"], "delta.stance_width");
  EXPECT_EQ(result["action"][4]["max"], 1);
  EXPECT_EQ(result["observation"][0]["name"], "p_WB.x");
  EXPECT_EQ(result["observation"][0]["unit"], "m");
  EXPECT_TRUE(result["observation"][0]["min"].is_null());
  EXPECT_EQ(result["observation"][77]["name"], "terrain.front_left");
  EXPECT_EQ(result["layout_version"], kLayoutVersion);
  EXPECT_EQ(result["layout_hash"].get<std::string>().size(), 16U);
}

TEST(EnvCommand, ListsItsTables) {
  const json result = run_json("env --list");
  EXPECT_EQ(result["observation_blocks"].size(), observation_blocks().size());
  EXPECT_EQ(result["reward_terms"].size(), reward_terms().size());
  EXPECT_EQ(result["randomisation"].size(), randomisation_rows().size());
}

TEST(EnvCommand, WritesAConfigurationThatRolloutReads) {
  const ProgramResult yaml =
      run_program("env --yaml --gait walk --terrain rough --episode-seconds 1 --engine " + engine_of_test());
  ASSERT_EQ(yaml.exit_code, 0) << yaml.err;
  std::ofstream("commands_env.yaml") << yaml.out;
  const json result = run_json("rollout --config commands_env.yaml --episodes 2");
  EXPECT_EQ(result["gait"], "walk");
  EXPECT_EQ(result["terrain"], "rough");
  EXPECT_NEAR(result["policies"][0]["all"]["simulated_seconds"], 2.0, 1e-9);
  std::filesystem::remove("commands_env.yaml");
}

TEST(EnvCommand, WritesNothingThatCannotBeRead) {
  expect_bad_input("env --yaml --adapt nope", {"nope", "step_height"});
  expect_bad_input("env --yaml --terrain rogh", {"rogh", "rough"});
  expect_bad_input("env --yaml --robot skara", {"skara", "scara_quadruped"});
}

TEST(EnvCommand, TakesParametersOutsideTheirRangeWithANote) {
  const ProgramResult result = run_program("env --describe --set cycle_time=.9 --json -");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err,
            "crossgait: note: cycle_time = 0.9 s lies outside the range for adaptation, 0.15 to 0.8 s\n");
  EXPECT_EQ(json::parse(result.out)["notes"].size(), 1U);
  write_file("commands_ranges.yaml", "ranges: {cycle_time: [.15, 1.5]}\nparameters: {cycle_time: .9}\n");
  const ProgramResult ranged = run_program("env --config commands_ranges.yaml --json -");
  EXPECT_EQ(ranged.err, "");
  EXPECT_EQ(json::parse(ranged.out)["notes"].size(), 0U);
  std::filesystem::remove("commands_ranges.yaml");
  const ProgramResult walk = run_program("env --gait walk:guide --adapt cycle_time");
  EXPECT_EQ(walk.exit_code, 0);
  EXPECT_NE(walk.err.find("cycle_time = 1.2 s"), std::string::npos) << "the gait's own, but it adapts";
  EXPECT_EQ(run_program("env --gait walk:guide --adapt step_length").err, "");
  const ProgramResult gait = run_program("gait --parameters --set cycle_time=.9");
  EXPECT_EQ(gait.exit_code, 0);
  EXPECT_NE(gait.err.find("cycle_time = 0.9 s"), std::string::npos);
}

// From any folder, and with the names that `env --yaml` was given.
TEST(EnvCommand, WritesFilesThatAreFoundFromAnywhere) {
  std::filesystem::create_directories("commands_folder");
  std::filesystem::copy_file(std::string(CROSSGAIT_SOURCE_DIR) + "/models/terrains/blocks.csv",
                             "commands it's.csv", std::filesystem::copy_options::overwrite_existing);
  const ProgramResult yaml = run_program("env --yaml --terrain \"commands it's.csv\"");
  ASSERT_EQ(yaml.exit_code, 0) << yaml.err;
  std::ofstream("commands_folder/env.yaml") << yaml.out;
  EXPECT_EQ(run_program("env --config commands_folder/env.yaml").exit_code, 0);
  write_file("commands_folder/near.yaml", "terrain: ../commands it's.csv\n");
  EXPECT_EQ(run_program("env --config commands_folder/near.yaml").exit_code, 0);
  write_file("commands_folder/far.yaml", "gait: trot\nterrain: commands it's.csv\n");
  expect_bad_input("env --config commands_folder/far.yaml", {"far.yaml: line 2, terrain"});
  std::filesystem::remove_all("commands_folder");
  std::filesystem::remove("commands it's.csv");
}

TEST(RolloutCommand, ShowsPoliciesAndTheBaselineInEveryEngine) {
  ASSERT_FALSE(available_engines().empty());
  for (const std::string& engine : available_engines()) {
    const std::string arguments =
        "rollout --policy random --baseline --episodes 2 --episode-seconds 1 --terrain rough --engine " +
        engine;
    const json result = run_json(arguments + " --workers 2");
    ASSERT_EQ(result["policies"].size(), 2U);
    EXPECT_EQ(result["policies"][1]["policy"], "zero");
    for (const json& policy : result["policies"]) {
      EXPECT_EQ(policy["episodes"].size(), 2U);
      EXPECT_EQ(policy["all"]["steps"], 1000);
      EXPECT_TRUE(policy["all"]["reward_terms"].contains("forward_velocity"));
    }
    EXPECT_EQ(run_json(arguments + " --workers 1"), result);  // whatever the number of threads
  }
}

TEST(RolloutCommand, OfTheZeroPolicyIsTheWalk) {
  ASSERT_FALSE(available_engines().empty());
  for (const std::string& engine : available_engines()) {
    const json walk = run_json("walk --terrain rough --seed 2 --seconds 1 --engine " + engine);
    const json rollout = run_json(
        "rollout --terrain rough --terrain-seed 2 --episode-seconds 1 --episodes 1 --engine " + engine);
    const json& episode = rollout["policies"][0]["episodes"][0];
    const std::set<std::string> of_the_run{"summary", "schema",    "engine",       "engine_version",
                                           "terrain", "gait",      "wall_seconds", "provenance",
                                           "contact", "not_of_law"};
    int numbers = 0;
    for (const auto& [key, value] : walk.items()) {
      if (of_the_run.contains(key)) continue;
      ASSERT_TRUE(episode.contains(key)) << key;
      EXPECT_EQ(episode[key], value) << key;
      ++numbers;
    }
    EXPECT_GE(numbers, 26);
    EXPECT_EQ(walk["outcome"], "walked");
    EXPECT_TRUE(walk["outcome_at_s"].is_null());
    EXPECT_EQ(rollout["policies"][0]["all"]["outcomes"]["walked"], 1);
  }
}

TEST(RolloutCommand, TracesAnEpisode) {
  const ProgramResult result = run_program(
      "rollout --episode-seconds .5 --episodes 1 --trace commands_trace.csv --engine " + engine_of_test());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  std::ifstream file("commands_trace.csv");
  std::string line;
  int rows = -1;
  while (std::getline(file, line)) ++rows;
  EXPECT_EQ(rows, 250);
  std::filesystem::remove("commands_trace.csv");
}

TEST(TransferCommand, FillsTheMatrix) {
  const json result =
      run_json("transfer --policy random --terrains \"flat;rough\" --episodes 1 --episode-seconds .5");
  EXPECT_EQ(result["cells"].size(), 2 * available_engines().size());
  for (const json& cell : result["cells"]) {
    EXPECT_EQ(cell["policy"]["episodes"], 1);
    EXPECT_NE(cell["policy"]["total_reward"]["mean"], cell["baseline"]["total_reward"]["mean"]);
  }
}

TEST(TuneCommand, FindsFasterParametersAndWritesThem) {
  const std::string arguments =
      "tune --adapt step_length --iterations 2 --population 6 --terrains 1 --unseen 1 --episode-seconds 2 "
      "--engines " +
      engine_of_test() + " --engine " + engine_of_test();
  const json result = run_json(arguments + " --workers 2 --out commands_tuned.yaml");
  const EnvConfig tuned = load_env_config("commands_tuned.yaml");
  EXPECT_GT(tuned.parameters.find("step_length").value(), find_gait("trot").preferred.step_length);
  EXPECT_EQ(tuned.parameters.find("step_length").value(), result["parameters"]["step_length"]);
  EXPECT_GT(result["history"].back(), result["history"].front().get<double>() - 1e-12);
  ASSERT_EQ(result["checks"].size(), 4U);  // default and tuned, on the seed tuned on and on another
  const auto speed = [&](std::size_t i) {
    return result["checks"][i]["all"]["mean_speed_mps"]["mean"].get<double>();
  };
  EXPECT_GT(speed(1), speed(0));
  EXPECT_GT(speed(3), speed(2));
  EXPECT_EQ(run_json(arguments + " --workers 1"), result);
  std::filesystem::remove("commands_tuned.yaml");
}

TEST(EnvironmentCommandsBadInput, NamesWhatWasWrong) {
  expect_bad_input("rollout --policy dance", {"dance", "zero, random"});
  expect_bad_input("rollout --config none.yaml", {"none.yaml"});
  expect_bad_input("rollout --policy none.safetensors", {"none.safetensors"});
  expect_bad_input("rollout --adapt girth", {"girth", "step_height"});
  expect_bad_input("rollout --observe smell", {"smell", "terrain"});
  expect_bad_input("rollout --policy-dt .003", {"policy_dt", "0.003"});
  expect_bad_input("rollout --episodes 0", {"--episodes"});
  expect_bad_input("rollout --engine none", {"none", engine_of_test()});
  expect_bad_input("transfer --terrains moon", {"moon"});
  expect_bad_input("tune --population 1", {"--population"});
  std::ofstream("commands_bad.yaml") << "gait: trot\nreward: {fun: 1}\n";
  expect_bad_input("rollout --config commands_bad.yaml", {"commands_bad.yaml", "line 2", "fun"});
  std::filesystem::remove("commands_bad.yaml");
}

}  // namespace
}  // namespace crossgait
