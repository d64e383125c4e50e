// Which engines can be compared, and what the comparison is told as.
#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "physics/core/error.h"
#include "study/walk.h"

namespace crossgait {
namespace {

std::string refusal(const std::vector<std::string>& engines) {
  try {
    static_cast<void>(compare_walks(WalkConfig(), engines));
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.element(), "--engines");
    return error.found();
  }
  return "none";
}

TEST(CompareWalks, TakesTwoEnginesOrMoreAndEachOnce) {
  EXPECT_EQ(refusal({}), "0");
  EXPECT_EQ(refusal({"mujoco"}), "1");
  EXPECT_EQ(refusal({"mujoco", "mujoco"}), "mujoco again");
  EXPECT_EQ(refusal({"mujoco", "bullet", "mujoco"}), "mujoco again");
  EXPECT_EQ(refusal({"mujoco", "bullet", "bullet"}), "bullet again");
}

TEST(CompareWalks, WalksInTheEnginesThatAreAskedFor) {
  if (available_engines().size() < 2) GTEST_SKIP() << "one engine alone";
  const std::vector<std::string> engines{available_engines().back(), available_engines().front()};
  WalkConfig config;
  config.gait = choose_gait("trot", {});
  config.timing = {.seconds = 0.1, .settle_seconds = 0.1};
  const WalkComparison result = compare_walks(config, engines);
  ASSERT_EQ(result.comparison.runs.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(result.comparison.runs[i].engine.name, engines[i]);
    EXPECT_NEAR(result.comparison.runs[i].summary.simulated_seconds, 0.1, 1e-12);  // rounding of 50 steps
  }
  EXPECT_FALSE(result.verdict.has_value());  // not asked for
  EXPECT_FALSE(result.interrupted);
}

TEST(CompareWalks, JudgesOneEngineOfEachSetOfLaws) {
  const std::vector<std::string> available = available_engines();
  for (const char* engine : {"mujoco", "bullet:matched", "bullet"}) {
    if (std::find(available.begin(), available.end(), engine) == available.end())
      GTEST_SKIP() << "needs " << engine;
  }
  WalkConfig config;
  config.gait = choose_gait("trot", {});
  config.timing = {.seconds = 0.1, .settle_seconds = 0.1};
  CompareOptions options;
  options.verdict = true;
  options.judge.starts = 4;
  std::size_t judging = 0;
  const auto progress = [&judging](const std::string& stage, double) { judging += stage == "judging"; };
  const auto verdict =
      compare_walks(config, {"mujoco", "bullet:matched", "bullet"}, options, progress).verdict;
  ASSERT_TRUE(verdict.has_value());
  ASSERT_EQ(verdict->verdicts.pairs.size(), 1U);
  EXPECT_EQ(verdict->verdicts.pairs[0].a + " " + verdict->verdicts.pairs[0].b, "mujoco bullet");
  // As asked and at half the step in both, two settings of soft contact in the one, sweeps and error
  // reduction in the other; four starts: one report per run.
  EXPECT_EQ(judging, 4U * (2 + 2 + 2 + 2));
  EXPECT_FALSE(compare_walks(config, {"mujoco", "bullet:matched"}, options).verdict.has_value());
}

TEST(CompareWalks, AreReportedWithTheirVerdict) {
  WalkComparison result;
  result.comparison.runs.resize(2);
  result.comparison.runs[1].engine.name = "other";
  nlohmann::ordered_json json = report(result);
  EXPECT_EQ(json["schema"]["name"], "compare");
  EXPECT_EQ(json["runs"][1]["engine"], "other");
  EXPECT_FALSE(json.contains("verdict"));
  EXPECT_FALSE(json.contains("interrupted"));
  result.verdict.emplace();
  result.verdict->verdicts.pairs.resize(1);
  result.verdict->verdicts.pairs[0].b = "third";
  result.verdict->backgrounds.resize(1);
  result.interrupted = true;
  json = report(result);
  EXPECT_EQ(json["verdict"]["pairs"][0]["engines"][1], "third");
  EXPECT_FALSE(json["verdict"].contains("schema"));
  EXPECT_EQ(json["interrupted"], true);
}

TEST(Walk, IsReportedWithItsSchema) {
  WalkRun run;
  run.engine.name = "some";
  const nlohmann::ordered_json json = report(run);
  EXPECT_EQ(json["schema"]["name"], "walk");
  EXPECT_EQ(json["engine"], "some");
}

}  // namespace
}  // namespace crossgait
