// The benchmark's result as JSON, and what is made of it.
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "benchmarks/bench.h"
#include "benchmarks/regression.h"
#include "physics/core/error.h"

namespace crossgait::benchmarks {
namespace {

using nlohmann::ordered_json;

/// A small result written by hand: two engines, the first the one that times are compared to.
ordered_json hand_written() {
  ordered_json result = ordered_json::parse(R"({
    "schema": {"name": "bench", "version": "draft"}, "quick": false, "machine": {"cores": 2},
    "engines": [{"name": "a"}, {"name": "b"}],
    "speed": {
      "scenes": [
        {"scene": "stand", "engine": "a", "contacts": 4, "us_per_step": 10, "us_per_step_quartiles": [9, 11],
         "ratio": 1, "ratio_quartiles": [1, 1], "steps_per_core_second": 1e5, "real_time_factor": 100},
        {"scene": "stand", "engine": "b", "contacts": 4, "us_per_step": 20, "us_per_step_quartiles": [19, 21],
         "ratio": 2, "ratio_quartiles": [1.9, 2.1], "steps_per_core_second": 5e4, "real_time_factor": 50}],
      "eta": [{"terrain": "flat", "engine": "b", "eta": 0.9, "walk_us_per_step": 1, "engine_us_per_step": 1}],
      "threads": [{"engine": "b", "threads": 1, "steps_per_second": 5e4, "efficiency": 1},
                  {"engine": "b", "threads": 2, "steps_per_second": 9e4, "efficiency": 0.9}]},
    "accuracy": {
      "points": [
        {"terrain": "flat", "engine": "a", "step_s": 0.001, "position_error_m": 1e-5, "joint_error_rad": 1e-4,
         "cost": 0.02, "cost_ratio": 1},
        {"terrain": "flat", "engine": "b", "step_s": 0.001, "position_error_m": null, "joint_error_rad": null,
         "cost": 0.03, "cost_ratio": 1.5}],
      "stable_steps": [{"terrain": "flat", "engine": "a", "largest_s": 0.016},
                       {"terrain": "flat", "engine": "b", "largest_s": null}]},
    "analytic": {
      "convergence": [{"quantity": "tumbling_energy", "unit": "relative", "engine": "a", "order": 1.0,
                       "step_s": [0.002, 0.001], "error": [-0.02, -0.01]}],
      "friction": [{"ground": "plane", "engine": "b", "creep_inside_mps": 1e-12,
                    "distance_error_outside": 0.001, "range_over_headings": 1e-6}]},
    "feet": [{"terrain": "flat", "engine": "a", "stand_seconds": 60, "creep_mps": 1e-5, "penetration_m": 1e-3,
              "force_error": -1e-7, "strides": 6, "touchdowns": 24, "touchdown_impulse_Ns": 0.02,
              "touchdown_peak_over_weight": 0.4, "slip_per_stride_m": 0.004, "toe_drag_per_stride_m": 0.02,
              "deepest_penetration_m": 0.002}]})");
  return result;
}

std::vector<std::string> names(const std::vector<Change>& changes) {
  std::vector<std::string> result;
  for (const Change& c : changes) result.push_back(c.name);
  return result;
}

TEST(Comparison, EqualResultsAreEqual) {
  const Regression r = compare_results(hand_written(), hand_written(), 1.01);
  EXPECT_TRUE(r.worse.empty());
  EXPECT_TRUE(r.better.empty());
  EXPECT_TRUE(r.missing.empty());
  EXPECT_EQ(r.compared, static_cast<int>(comparable_figures(hand_written()).size()));
  EXPECT_NE(describe(r).find("0 worse"), std::string::npos);
}

TEST(Comparison, TheMachinesSpeedCancels) {
  ordered_json slower = hand_written();
  for (ordered_json& r : slower["speed"]["scenes"]) r["us_per_step"] = 3 * r["us_per_step"].get<double>();
  for (ordered_json& p : slower["accuracy"]["points"]) p["cost"] = 3 * p["cost"].get<double>();
  const Regression r = compare_results(hand_written(), slower, 1.01);
  EXPECT_TRUE(r.worse.empty());
  EXPECT_TRUE(r.better.empty());
}

TEST(Comparison, FlagsWhatGotWorse) {
  ordered_json after = hand_written();
  after["speed"]["scenes"][1]["ratio"] = 3;                      // 1.5 times
  after["speed"]["eta"][0]["eta"] = 0.45;                        // half: the walk takes twice as long
  after["speed"]["threads"][1]["efficiency"] = 0.8;              // within the factor
  after["accuracy"]["points"][0]["position_error_m"] = nullptr;  // it diverges now
  after["analytic"]["convergence"][0]["error"][1] = 0.03;        // thrice, the other sign
  after["accuracy"]["stable_steps"][0]["largest_s"] = 0.008;     // half
  after["feet"][0]["slip_per_stride_m"] = 0.001;                 // better
  const Regression r = compare_results(hand_written(), after, 1.25);
  EXPECT_EQ(names(r.worse),
            (std::vector<std::string>{
                "accuracy, flat, 1 ms: base of a, m", "analytic, tumbling_energy of a at 1 ms",
                "speed, walk on flat: time over that of b alone",
                "accuracy, flat: 1 / largest stable step of a, 1/s", "speed, stand: time of b over a"}));
  EXPECT_TRUE(std::isinf(r.worse[0].factor));
  EXPECT_NEAR(r.worse[1].factor, 3, 1e-12);
  EXPECT_NEAR(r.worse[4].factor, 1.5, 1e-12);
  ASSERT_EQ(r.better.size(), 1U);
  EXPECT_NEAR(r.better[0].factor, 0.25, 1e-12);
  const ordered_json json = to_json(r);
  EXPECT_EQ(json["worse"].size(), 5U);
  EXPECT_TRUE(json["worse"][0]["now"].is_null());  // JSON has no infinity
  for (const std::string& name : names(r.worse)) EXPECT_NE(describe(r).find(name), std::string::npos);
}

TEST(Comparison, RoundingErrorsAreNeitherBetterNorWorse) {
  ordered_json after = hand_written();
  after["analytic"]["friction"][0]["creep_inside_mps"] = 9e-10;  // 900 times as much of nothing
  after["feet"][0]["force_error"] = 9e-7;
  after["analytic"]["friction"][0]["range_over_headings"] = 9e-5;
  EXPECT_TRUE(compare_results(hand_written(), after, 1.25).worse.empty());
}

TEST(Comparison, SettingsArePartOfAFiguresName) {
  ordered_json quick = hand_written();
  quick["feet"][0]["stand_seconds"] = 10;
  quick.erase("analytic");  // not measured: not missed either
  const Regression r = compare_results(hand_written(), quick, 1.25);
  EXPECT_EQ(r.missing.size(), 8U);
  for (const std::string& name : r.missing) EXPECT_EQ(name.rfind("feet", 0), 0U) << name;
}

TEST(Comparison, RefusesWhatMakesNoSense) {
  EXPECT_THROW(compare_results(hand_written(), hand_written(), 1), ConfigError);
  EXPECT_THROW(compare_results(hand_written(), hand_written(), std::nan("")), ConfigError);
  ordered_json speed = hand_written(), feet = hand_written();
  for (const char* section : {"accuracy", "analytic", "feet"}) speed.erase(section);
  for (const char* section : {"accuracy", "analytic", "speed"}) feet.erase(section);
  EXPECT_THROW(compare_results(speed, feet, 2), ConfigError);
  ordered_json other = hand_written();
  other["robot"] = "another";
  EXPECT_THROW(compare_results(hand_written(), other, 2), ConfigError);
}

TEST(Comparison, CountsTheReboundWhereBothResultsHaveIt) {
  ordered_json before = hand_written(), after = hand_written();
  const auto rebound = [](double share) {
    return ordered_json::array({{{"engine", "b"}, {"step_s", 0.001}, {"share_of_speed", share}}});
  };
  after["analytic"]["rebound"] = rebound(0.5);
  EXPECT_TRUE(compare_results(before, after, 1.25).missing.empty());
  before["analytic"]["rebound"] = rebound(0.1);
  EXPECT_EQ(names(compare_results(before, after, 1.25).worse),
            (std::vector<std::string>{"analytic, rebound in b at 1 ms"}));
  EXPECT_NE(describe_bench(after).find("0.5000"), std::string::npos);
}

TEST(StoredResult, IsReadBack) {
  std::ofstream("bench_result.json") << hand_written();
  EXPECT_EQ(read_bench("bench_result.json"), hand_written());
  std::filesystem::remove("bench_result.json");
  const std::string text = describe_bench(hand_written());
  for (const char* word : {"stand", "20.00", "diverged", "none", "tumbling_energy"}) {
    EXPECT_NE(text.find(word), std::string::npos) << word << " not in\n" << text;
  }
}

void expect_refused(const std::string& text, const std::string& word) {
  std::ofstream("bench_bad.json") << text;
  try {
    read_bench("bench_bad.json");
    ADD_FAILURE() << "accepted: " << text;
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("bench_bad.json"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
  std::filesystem::remove("bench_bad.json");
}

TEST(StoredResult, RefusesAnythingElse) {
  EXPECT_THROW(read_bench("bench_missing.json"), ConfigError);
  EXPECT_THROW(read_bench("."), ConfigError);
  expect_refused(std::string(100000, '['), "at most 32 levels");
  expect_refused(std::string(2 << 20, ' '), "at most 1 MiB");
  std::string keys = "{";
  for (int i = 0; i < 20000; ++i) keys += "\"" + std::to_string(i) + "\":0,";
  expect_refused(keys + "\"a\":0}", "at most 10000 values");
  expect_refused("no json", "schema");
  expect_refused("[1, 2]", "schema");
  expect_refused(R"({"schema": "something-else"})", "schema");
  expect_refused(R"({"schema": 7})", "schema");
  expect_refused(R"({"schema": {"name": "bench", "version": 99}})", "schema");
  expect_refused(R"({"schema": {"name": "bench", "version": "draft"}})", "engines");
  ordered_json result = hand_written();
  result["engines"].clear();
  expect_refused(result.dump(), "engines");
  result = hand_written();
  result["speed"]["scenes"][0].erase("us_per_step");
  expect_refused(result.dump(), "us_per_step");
  result = hand_written();
  result["feet"][0]["creep_mps"] = "fast";
  expect_refused(result.dump(), "string");
}

TEST(RunBench, RefusesBadSelections) {
  const auto run = [](std::vector<std::string> engines, std::vector<std::string> sections) {
    return run_bench({.engines = std::move(engines), .sections = std::move(sections), .quick = true},
                     [](double) {});
  };
  const std::string engine = available_engines().front();
  EXPECT_THROW(run({}, {"analytic"}), ConfigError);
  EXPECT_THROW(run({"nonsense"}, {"analytic"}), ConfigError);
  EXPECT_THROW(run({engine, engine}, {"analytic"}), ConfigError);
  EXPECT_THROW(run({engine}, {"beauty"}), ConfigError);
  EXPECT_THROW(run({engine}, {"feet", "feet"}), ConfigError);
  const BenchOptions legless{
      .engines = {engine}, .sections = {"analytic"}, .quick = true, .robot = scenes::tumbling_body()};
  EXPECT_THROW(run_bench(legless, [](double) {}), ConfigError);
}

TEST(RunBench, HoldsWhatWasAskedFor) {
  double last = 0;
  const ordered_json result =
      run_bench({.engines = available_engines(), .sections = {"analytic", "feet"}, .quick = true},
                [&last](double share) {
                  EXPECT_GE(share, last - 1e-12);
                  last = share;
                });
  EXPECT_NEAR(last, 1, 1e-9);
  EXPECT_TRUE(result["quick"]);
  EXPECT_FALSE(result.contains("speed"));
  EXPECT_FALSE(result.contains("accuracy"));
  const std::size_t engines = available_engines().size();
  EXPECT_EQ(result["engines"].size(), engines);
  EXPECT_EQ(result["analytic"]["convergence"].size(), 4 * engines);
  EXPECT_EQ(result["analytic"]["friction"].size(), 2 * engines);
  EXPECT_EQ(result["feet"].size(), 2 * engines);
  for (const char* key : {"date", "cores", "compiler", "eigen"})
    EXPECT_TRUE(result["machine"].contains(key)) << key;
  // Physics repeats itself: compared with itself it is the same, to the bit and through the file.
  std::ofstream("bench_run.json") << result;
  EXPECT_TRUE(compare_results(read_bench("bench_run.json"), result, 1.0000001).worse.empty());
  EXPECT_FALSE(describe_bench(result).empty());
  std::filesystem::remove("bench_run.json");
}

}  // namespace
}  // namespace crossgait::benchmarks
