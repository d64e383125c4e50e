// `crossgait verdict` and `compare --verdict` on the command line.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "crossgait/backends/registry.h"
#include "crossgait/tests/apps/run_program.h"

namespace crossgait {
namespace {

using nlohmann::json;

// Short runs of few starts: what is looked at is the contract, not the word.
const std::string kShort = " --seconds .2 --settle .1 --starts 4";

std::string contents(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

bool two_engines() { return available_engines().size() >= 2; }

TEST(VerdictCommand, KeepsItsContract) {
  if (!two_engines()) GTEST_SKIP() << "one engine alone";
  const json verdict = run_json("verdict" + kShort);
  for (const char* key : {"behaviour", "a", "b", "word", "starts", "limit", "confidence", "variations",
                          "left_out", "statistics", "models"}) {
    EXPECT_TRUE(verdict.contains(key)) << key;
  }
  EXPECT_EQ(verdict["a"], available_engines().front());
  EXPECT_EQ(verdict["b"], available_engines().back());
  EXPECT_TRUE(verdict["models"].empty()) << verdict["models"];
  EXPECT_EQ(verdict["statistics"].size(), 8U);
  for (const json& s : verdict["statistics"]) {
    for (const char* key : {"name", "unit", "mean_a", "mean_b", "gap", "spread_a", "spread_b", "spread",
                            "floor", "score", "word"}) {
      EXPECT_TRUE(s.contains(key)) << key;
    }
    EXPECT_LE(s["score"]["low"].get<double>(), s["score"]["estimate"].get<double>());
    EXPECT_NEAR(s["gap"]["estimate"], s["mean_b"].get<double>() - s["mean_a"].get<double>(), 1e-12);
  }
}

TEST(VerdictCommand, JudgesPolicies) {
  if (!two_engines()) GTEST_SKIP() << "one engine alone";
  const json verdict = run_json("verdict --policy zero" + kShort);
  ASSERT_EQ(verdict["statistics"].size(), 9U);
  EXPECT_EQ(verdict["statistics"][8]["name"], "total reward");
  EXPECT_EQ(verdict["behaviour"], "policy zero on flat, 0.2 s");
}

TEST(VerdictCommand, FromStoredRunsGivesTheSameAndMakesNoRun) {
  if (!two_engines()) GTEST_SKIP() << "one engine alone";
  const std::string file = "verdict_stored_runs.jsonl";
  std::filesystem::remove(file);
  const std::string arguments = std::string("verdict --workers 2 --runs ") + file + kShort;
  const json first = run_json(arguments);
  const std::string runs = contents(file);
  EXPECT_GT(std::count(runs.begin(), runs.end(), '\n'), 8);
  const json second = run_json(arguments);
  EXPECT_EQ(second, first);
  EXPECT_EQ(contents(file), runs);  // what is made is added, so nothing was
  // Stopped halfway through a line.
  std::filesystem::resize_file(file, runs.size() / 2);
  EXPECT_EQ(run_json(arguments), first);
  EXPECT_EQ(contents(file).size(), runs.size());
  std::ofstream(file) << "garbage\n";
  expect_bad_input(arguments, {file, "line 1"});
  std::filesystem::remove(file);
}

TEST(VerdictCommand, ExplainsWhereThereIsAFamily) {
  if (engine_families().empty()) GTEST_SKIP() << "no engine is made of factors";
  const EngineFamily& family = engine_families().front();
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
        std::string("--policy nonsense")}) {
    EXPECT_EQ(run_program("verdict --seconds .1 " + arguments).exit_code, 2) << arguments;
  }
}

TEST(CompareCommand, JudgesPairsOfDifferentContactLaws) {
  if (!two_engines()) GTEST_SKIP() << "one engine alone";
  const json plain = run_json("compare --seconds .2");
  EXPECT_FALSE(plain.contains("verdicts"));
  const json judged = run_json("compare --seconds .2 --verdict --engines " + available_engines().front() +
                               "," + available_engines().back());
  ASSERT_EQ(judged["verdicts"].size(), 1U);
  EXPECT_EQ(judged["verdicts"][0]["starts"], 6);
}

}  // namespace
}  // namespace crossgait
