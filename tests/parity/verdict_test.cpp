// The rule on made-up runs whose truth is known, and that results do not hang on threads.
#include "parity/verdict.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "motion/gait_source.h"
#include "parity/verdict_report.h"
#include "physics/core/error.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

const std::vector<Statistic> kStatistics{{"distance", "m", 0.02, 0.005},
                                         {"failures", "fraction", 0, 0.05, true}};

// Distance 1 m, `noise` either way over starts that both engines share, `own` either way that they do not,
// `per_step` more at twice the time step, `offset` more in the second engine.
struct Truth {
  double noise = 0, own = 0, per_step = 0, offset = 0;
};

RunTable runs(const Truth& truth, bool second, std::size_t starts) {
  Random own(second ? 2 : 1);
  RunTable table;
  for (const Variation& v : variations()) {
    Random shared(7);
    table.emplace_back();
    for (std::size_t k = 0; k < starts; ++k) {
      const double distance = 1 + truth.noise * shared.uniform(-1, 1) + truth.own * own.uniform(-1, 1) +
                              truth.per_step * (v.step - 1) + (second ? truth.offset : 0);
      table.back().push_back({distance, 0});
    }
  }
  return table;
}

StatisticVerdict judged(const Truth& truth, std::size_t starts = 12) {
  VerdictOptions options;
  options.starts = starts;
  return judge(kStatistics, variations(), runs(truth, false, starts), runs(truth, true, starts), options)
      .front();
}

TEST(Judge, EqualRunsAgree) {
  const StatisticVerdict v = judged({.noise = 0.1});
  EXPECT_EQ(v.value, VerdictValue::kAgrees);
  EXPECT_EQ(v.gap.estimate, 0);
  // Uniform over +-.1: standard deviation .1 / sqrt(3), of 12 samples good to a third.
  EXPECT_NEAR(v.spread_a.starts, 0.1 / std::sqrt(3), 0.02);
  EXPECT_NEAR(v.spread_a.time_step, 0, 1e-12);
}

TEST(Judge, AGapFarBeyondTheSpreadIsTheEngines) {
  const StatisticVerdict v = judged({.noise = 0.02, .offset = 0.2});
  EXPECT_EQ(v.value, VerdictValue::kEngineDependent);
  EXPECT_NEAR(v.gap.estimate, 0.2, 1e-12);
  EXPECT_GT(v.score.low, 1);
}

TEST(Judge, AGapWithinTheSpreadAgreesHoweverSignificant) {
  // The same .03 m at every start, and starts .17 m apart: certain, and smaller than what one engine does
  // itself.
  const StatisticVerdict v = judged({.noise = 0.3, .offset = 0.03});
  EXPECT_GT(v.gap.low, 0);
  EXPECT_EQ(v.value, VerdictValue::kAgrees);
}

TEST(Judge, AGapNobodyWouldActOnAgreesHoweverRepeatable) {
  const StatisticVerdict v = judged({.offset = 0.01});  // floor .02 m, spread nil
  EXPECT_EQ(v.spread, 0);
  EXPECT_GT(v.gap.low, 0);
  EXPECT_EQ(v.value, VerdictValue::kAgrees);
}

TEST(Judge, TheTimeStepCountsAsSpread) {
  EXPECT_EQ(judged({.offset = 0.05}).value, VerdictValue::kEngineDependent);
  const StatisticVerdict v = judged({.per_step = 0.2, .offset = 0.05});
  // Means at half, one and two steps: -.1, 0, .2.
  EXPECT_NEAR(v.spread_a.time_step, std::sqrt((0.01 + 0.04 - 0.01 / 3) / 2), 1e-12);
  EXPECT_EQ(v.value, VerdictValue::kAgrees);
}

TEST(Judge, WhatFewRunsCannotTellIsUnresolvedAndManyResolve) {
  const Truth truth{.noise = 0, .own = 0.1, .offset = 0.085};  // 1.4 standard deviations
  EXPECT_EQ(judged(truth, 6).value, VerdictValue::kUnresolved);
  EXPECT_EQ(judged(truth, 400).value, VerdictValue::kEngineDependent);
}

TEST(Judge, IsRarelyWrong) {
  // Truth on the limit: either word is wrong, and together they may be said in 5 % of cases (here the share
  // of one of two statistics: 2.5 %, half of it on each side of a limit).
  int words = 0;
  constexpr int kRepetitions = 1000;
  for (int r = 0; r < kRepetitions; ++r) {
    Random random(static_cast<std::uint64_t>(r));
    RunTable a(1), b(1);
    const std::vector<Variation> nominal{variations().front()};
    const double spread = 0.1 / std::sqrt(3), offset = std::hypot(spread, 0.02 * 1.03);
    for (int k = 0; k < 12; ++k) {
      a[0].push_back({1 + random.uniform(-0.1, 0.1), 0});
      b[0].push_back({1 + offset + random.uniform(-0.1, 0.1), 0});
    }
    if (judge(kStatistics, nominal, a, b, {}).front().value != VerdictValue::kUnresolved) ++words;
  }
  EXPECT_LE(static_cast<double>(words) / kRepetitions, 0.05);
}

// Fails at twice the time step; refuses other steps than the walk's.
Behaviour brittle() {
  Behaviour behaviour;
  behaviour.name = "brittle";
  behaviour.statistics = kStatistics;
  behaviour.physics_dt = 1e-3;
  behaviour.control_dt = 2e-3;
  behaviour.run = [](const Engine&, const Variation& v, std::size_t) {
    return v.step > 1 ? std::vector<double>{100, 1} : std::vector<double>{1, 0};
  };
  return behaviour;
}

const Engine kNothing{{"nothing", {}, {}, {}, {}, {}},
                      [](const WorldSpec&) { return std::unique_ptr<PhysicsBackend>(); }};

TEST(ReachVerdict, LeavesOutVariationsThatFailOrCannotBe) {
  Behaviour behaviour = brittle();
  Verdict verdict = reach_verdict(behaviour, kNothing, kNothing, {});
  ASSERT_EQ(verdict.left_out.size(), 1U);
  EXPECT_NE(verdict.left_out[0].find("12 of 12 runs fail"), std::string::npos) << verdict.left_out[0];
  EXPECT_EQ(verdict.variations.size(), variations().size() - 1);
  EXPECT_EQ(verdict.statistics[0].spread, 0);
  behaviour.control_dt = 1e-3;
  verdict = reach_verdict(behaviour, kNothing, kNothing, {});
  ASSERT_EQ(verdict.left_out.size(), 1U);
  EXPECT_NE(verdict.left_out[0].find("whole number"), std::string::npos) << verdict.left_out[0];
}

TEST(ReachVerdict, RefusesImpossibleOptions) {
  EXPECT_THROW(reach_verdict(brittle(), kNothing, kNothing, {.starts = 3}), ConfigError);
  EXPECT_THROW(reach_verdict(brittle(), kNothing, kNothing, {.limit = 0}), ConfigError);
  EXPECT_THROW(reach_verdict(brittle(), kNothing, kNothing, {.confidence = 1}), ConfigError);
}

Verdict short_trot(const std::string& a, const std::string& b, std::size_t workers) {
  const WorldSpec spec = scenes::world_of(scenes::quadruped());
  WalkSetup setup;
  setup.gait = "trot";
  setup.timing = {.seconds = 0.3, .settle_seconds = 0.1};
  setup.make_controller = [](const WorldSpec& world) {
    return make_gait_controller(choose_gait("trot", {}), world);
  };
  const Behaviour behaviour =
      walk_behaviour(spec, setup, [](std::size_t k) { return make_terrain("rough:size_x=2,size_y=2", k); });
  VerdictOptions options;
  options.starts = 4;
  options.workers = workers;
  return reach_verdict(behaviour, find_engine(a), find_engine(b), options);
}

TEST(ReachVerdict, DoesNotHangOnThreads) {
  const std::vector<std::string> names = available_engines();
  if (names.empty()) GTEST_SKIP() << "no engine is built in";
  const auto text = [&](std::size_t workers) {
    return to_json(short_trot(names.front(), names.back(), workers)).dump();
  };
  EXPECT_EQ(text(1), text(3));
}

TEST(ReachVerdict, EnginesOfOneContactLawAgree) {
  std::vector<std::string> matched;
  for (const std::string& name : available_engines()) {
    if (find_engine(name).info.laws == find_engine(available_engines().front()).info.laws)
      matched.push_back(name);
  }
  if (matched.size() < 2) GTEST_SKIP() << "no two engines declare the same contact law";
  const Verdict verdict = short_trot(matched[0], matched[1], 1);
  EXPECT_EQ(verdict.value(), VerdictValue::kAgrees) << describe(verdict);
  ASSERT_FALSE(verdict.statistics.empty());
  for (const StatisticVerdict& v : verdict.statistics) {
    measured(v.statistic.name + ", score", v.score.estimate);
    // Measured 2.2e-9 (RMS roll) at the solver tolerance of everyday use; a hundred times that, and up.
    EXPECT_NEAR(v.score.estimate, 0, 1e-6) << v.statistic.name;
  }
}

}  // namespace
}  // namespace crossgait
