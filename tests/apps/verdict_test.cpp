// `crossgait verdict` and `compare --verdict` on the command line.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "physics/robot_files/data_path.h"
#include "tests/apps/run_program.h"

namespace crossgait {
namespace {

using nlohmann::json;

// Short runs of few starts: what is looked at is the contract, not the word.
const std::string kShort = " --seconds .2 --settle .1 --starts 4";

// Two, comma-separated.
std::optional<std::string> engines_of_one_law() {
  const std::vector<std::string> all = available_engines();
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (find_engine(all[i]).info.laws == find_engine(all[k]).info.laws) return all[k] + "," + all[i];
    }
  }
  return std::nullopt;
}

bool has_two_engines() { return available_engines().size() >= 2; }

TEST(VerdictCommand, KeepsItsContract) {
  if (!has_two_engines()) GTEST_SKIP() << "one engine alone";
  const json verdict = run_json("verdict" + kShort);
  for (const char* key : {"behaviour", "a", "b", "verdict", "starts", "limit", "confidence", "variations",
                          "left_out", "statistics", "models"}) {
    EXPECT_TRUE(verdict.contains(key)) << key;
  }
  EXPECT_EQ(verdict["a"], available_engines().front());
  const std::vector<std::string> all = available_engines();
  const auto other = std::find_if(all.begin(), all.end(), [&all](const std::string& name) {
    return find_engine(name).info.laws != find_engine(all.front()).info.laws;
  });
  ASSERT_NE(other, all.end());
  EXPECT_EQ(verdict["b"], *other);
  EXPECT_TRUE(verdict["models"].empty()) << verdict["models"];
  EXPECT_EQ(verdict["statistics"].size(), 11U);
  for (const json& s : verdict["statistics"]) {
    for (const char* key : {"name", "unit", "mean_a", "mean_b", "gap", "spread_a", "spread_b", "spread",
                            "floor", "score", "verdict"}) {
      EXPECT_TRUE(s.contains(key)) << key;
    }
    EXPECT_LE(s["score"]["low"].get<double>(), s["score"]["estimate"].get<double>());
    EXPECT_NEAR(s["gap"]["estimate"], s["mean_b"].get<double>() - s["mean_a"].get<double>(), 1e-12);
  }
}

TEST(VerdictCommand, JudgesPolicies) {
  if (!has_two_engines()) GTEST_SKIP() << "one engine alone";
  const json verdict = run_json("verdict --policy zero" + kShort);
  ASSERT_EQ(verdict["statistics"].size(), 12U);
  EXPECT_EQ(verdict["statistics"].back()["name"], "total reward");
  EXPECT_EQ(verdict["behaviour"], "policy zero on flat, 0.2 s");
}

TEST(VerdictCommand, JudgesAPolicyInTheWorldOfItsConfiguration) {
  if (!has_two_engines()) GTEST_SKIP() << "one engine alone";
  const std::string file = write_file(
      "verdict_env.yaml", "terrain: rough\nfriction: .3\nepisode_seconds: .2\nsettle_seconds: .1\n");
  const json verdict = run_json("verdict --starts 4 --policy zero --config " + file);
  EXPECT_EQ(verdict["behaviour"], "policy zero on rough, 0.2 s");
  // As one that the options describe, which is the same world.
  const json typed = run_json("verdict --policy zero --terrain rough --friction .3" + kShort);
  EXPECT_EQ(verdict["statistics"], typed["statistics"]);
  const json other = run_json("verdict --policy zero" + kShort);
  EXPECT_NE(verdict["statistics"], other["statistics"]);
  std::filesystem::remove(file);
}

TEST(VerdictCommand, PushesPoliciesAsItPushesWalks) {
  if (!has_two_engines()) GTEST_SKIP() << "one engine alone";
  const json soft = run_json("verdict --policy zero --push 0" + kShort);
  const json hard = run_json("verdict --policy zero --push .5" + kShort);
  EXPECT_EQ(soft["provenance"]["starts"]["push_mps"], 0);
  EXPECT_NE(soft["statistics"][0]["mean_a"], hard["statistics"][0]["mean_a"]);
}

TEST(VerdictCommand, FromStoredRunsGivesTheSameAndMakesNoRun) {
  if (!has_two_engines()) GTEST_SKIP() << "one engine alone";
  const std::string file = "verdict_stored_runs.jsonl";
  std::filesystem::remove(file);
  const std::string arguments = std::string("verdict --workers 2 --runs ") + file + kShort;
  const json first = run_json(arguments);
  const std::string runs = read_file(file);
  EXPECT_GT(std::count(runs.begin(), runs.end(), '\n'), 8);
  const json second = run_json(arguments);
  EXPECT_EQ(second, first);
  EXPECT_EQ(read_file(file), runs);  // what is made is added, so nothing was
  // Stopped halfway through a line.
  std::filesystem::resize_file(file, runs.size() / 2);
  EXPECT_EQ(run_json(arguments), first);
  EXPECT_EQ(read_file(file).size(), runs.size());
  std::ofstream(file) << "garbage\n";
  expect_bad_input(arguments, {file, "line 1"});
  std::filesystem::remove(file);
}

TEST(VerdictCommand, ExplainsWhereThereIsAFamily) {
  if (engine_families().empty()) GTEST_SKIP() << "no engine is made of factors";
  const EngineFamily family =
      family_for(engine_families().front(), load_robot(find_robot("scara_quadruped")));
  const json verdict =
      run_json("verdict --explain --engines " + family.from + "," + family.to + " " + kShort);
  const json& attribution = verdict["attribution"];
  EXPECT_EQ(attribution["factors"].size(), family.factors.size());
  ASSERT_EQ(attribution["statistics"].size(), verdict["statistics"].size());
  for (const json& s : attribution["statistics"]) {
    ASSERT_EQ(s["factors"].size(), family.factors.size());
    double effects = 0, steps = 0;
    for (const json& i : s["factors"]) {
      effects += i["effect"]["estimate"].get<double>();
      steps += i["step"]["estimate"].get<double>();
    }
    // Both ways of sharing out sum to the gap.
    const double gap = s["gap"]["estimate"];
    EXPECT_NEAR(effects, gap, 1e-9 * (1 + std::abs(gap))) << s["name"];
    EXPECT_NEAR(steps, gap, 1e-9 * (1 + std::abs(gap))) << s["name"];
  }
}

TEST(VerdictCommand, RefusesWhatItCannotJudge) {
  const std::string one = available_engines().front();
  for (const std::string& arguments :
       {"--engines " + one, "--engines " + one + "," + one, "--engines " + one + ",nonsense",
        std::string("--starts 2"), std::string("--confidence 1"), std::string("--limit 0"),
        std::string("--config env.yaml"), std::string("--policy zero --config env.yaml --terrain rough"),
        std::string("--policy nonsense"), std::string("--policy zero --no-compensation"),
        std::string("--runs nowhere/at/all.jsonl")}) {
    EXPECT_EQ(run_program("verdict --seconds .1 " + arguments).exit_code, 2) << arguments;
  }
}

TEST(CompareCommand, JudgesPairsOfDifferentContactLaws) {
  if (!has_two_engines()) GTEST_SKIP() << "one engine alone";
  const json plain = run_json("compare --seconds .2");
  EXPECT_FALSE(plain.contains("verdicts"));
  const json judged = run_json("compare --seconds .2 --verdict --engines " + available_engines().front() +
                               "," + available_engines().back());
  ASSERT_EQ(judged["verdicts"].size(), 1U);
  EXPECT_EQ(judged["verdicts"][0]["starts"], 6);
}

TEST(CompareCommand, AsksForParityWhereLawsAreTheSame) {
  const auto same = engines_of_one_law();
  if (!same) GTEST_SKIP() << "no two engines of one law";
  const std::string compare = "compare --seconds .3 --engines " + *same;
  const ProgramResult judged = run_program(compare + " --verdict --require");
  EXPECT_EQ(judged.exit_code, 0) << judged.err;
  EXPECT_NE(judged.out.find("follow the same laws"), std::string::npos) << judged.out;
  const json result = run_json(compare + " --verdict");
  EXPECT_TRUE(result["pairs"][0]["same_laws"]);
  EXPECT_FALSE(result.contains("verdicts"));
}

TEST(CompareCommand, FailsWhereRequiredParityIsMissed) {
  const auto same = engines_of_one_law();
  if (!same) GTEST_SKIP() << "no two engines of one law";
  // Tumbling over high bumps, rounding grows from 1e-15 m to beyond 1e-6 m within some seconds.
  const std::string compare =
      "compare --terrain rough:amplitude=.08 --gait trot:guide --seconds 10 --engines " + *same;
  const json result = run_json(compare);
  ASSERT_TRUE(result["pairs"][0]["first_divergence"].is_object()) << result["pairs"];
  const ProgramResult required = run_program(compare + " --require");
  EXPECT_EQ(required.exit_code, 1);
  EXPECT_NE(required.err.find("parity"), std::string::npos) << required.err;
}

TEST(CompareCommand, RequiresParityOfEnginesOfOneLawAlone) {
  if (!has_two_engines()) GTEST_SKIP() << "one engine alone";
  const std::string engines = available_engines().front() + "," + available_engines().back();
  if (find_engine(available_engines().front()).info.laws == find_engine(available_engines().back()).info.laws)
    GTEST_SKIP() << "all of one law";
  expect_bad_input("compare --require --engines " + engines, {"--require", "same laws"});
}

}  // namespace
}  // namespace crossgait
