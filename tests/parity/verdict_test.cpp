// Verdicts of made-up behaviours whose truth is known, and of short real ones.
#include "parity/verdict.h"

#include <atomic>
#include <cmath>
#include <mutex>
#include <set>

#include <nlohmann/json.hpp>

#include "motion/gait_source.h"
#include "parity/verdict_report.h"
#include "physics/core/random.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

Engine nothing(const std::string& name, Capabilities capabilities = {}) {
  EngineInfo info;
  info.name = name;
  info.capabilities = capabilities;
  return {info, [](const WorldSpec&) { return std::unique_ptr<PhysicsBackend>(); }};
}

/// A run of five seconds at `speed`, cut where asked, or where it falls.
struct MadeUp {
  std::function<double(const Engine&, const Variation&, std::size_t start)> speed;
  /// When it falls, s; infinite for never.
  std::function<double(const Engine&, const Variation&, std::size_t start)> falls = {};

  Behaviour behaviour() const {
    Behaviour b;
    b.name = "made up";
    b.statistics = {{"way_m", "way", "m", {0, 0.01, true, "by hand"}}};
    b.seconds = 5;
    b.physics_dt = 1e-3;
    b.control_dt = b.cut_dt = 4e-3;
    b.run = [own = *this](const Engine& engine, const Variation& variation, std::size_t start,
                          double horizon) {
      const double fall = own.falls ? own.falls(engine, variation, start) : kToTheEnd;
      const double seconds = std::min({5.0, horizon, fall});
      return BehaviourRun{{seconds * own.speed(engine, variation, start)},
                          fall <= std::min(5.0, horizon) ? Outcome::kFell : Outcome::kWalked,
                          seconds};
    };
    return b;
  }
};

double by_start(std::size_t start, std::uint64_t stream) {
  return Random(derived_seed(stream, start)).uniform(-1, 1);
}

const std::vector<Engine> kTwo{nothing("a"), nothing("b")};

TEST(ReachVerdicts, JudgesPairedDifferences) {
  // Starts lie 0.5 m/s apart; the second engine is 0.1 m/s faster, give or take 0.002.
  const MadeUp truth{[](const Engine& e, const Variation&, std::size_t k) {
    return 1 + 0.5 * by_start(k, 1) + (e.name() == "b" ? 0.1 + 0.002 * by_start(k, 2) : 0);
  }};
  const Verdicts all = reach_verdicts(truth.behaviour(), kTwo, {});
  ASSERT_EQ(all.pairs.size(), 1U);
  const Verdict& v = all.pairs.front();
  EXPECT_EQ(v.word, Word::kDiffers);
  EXPECT_NEAR(v.statistics[0].gap.estimate, 0.5, 0.01);
  EXPECT_EQ(v.statistics[0].margin, 0.05);
  EXPECT_EQ(v.statistics.back().statistic.key, "failures");
  EXPECT_EQ(v.outcomes_a[static_cast<std::size_t>(Outcome::kWalked)], 12U);
  EXPECT_FALSE(v.cut.has_value());
  VerdictOptions wide;
  wide.margins["way_m"] = {0, 0.6, false, "stated"};
  EXPECT_EQ(reach_verdicts(truth.behaviour(), kTwo, wide).pairs.front().word, Word::kAgrees);
  wide.margins["no_such"] = wide.margins["way_m"];
  EXPECT_THROW(reach_verdicts(truth.behaviour(), kTwo, wide), ConfigError);
}

// In the second engine it falls after 2 s from every other start. Up to there both do the same.
TEST(ReachVerdicts, CutsEveryPairAtItsEarlierFailure) {
  const MadeUp truth{[](const Engine&, const Variation&, std::size_t k) { return 1 + 0.5 * by_start(k, 1); },
                     [](const Engine& e, const Variation&, std::size_t k) {
                       return e.name() == "b" && k % 2 == 0 ? 2.0 : kToTheEnd;
                     }};
  const Verdict v = reach_verdicts(truth.behaviour(), kTwo, {.starts = 24}).pairs.front();
  EXPECT_EQ(v.statistics[0].word, Word::kAgrees) << v.statistics[0].reason;
  EXPECT_NEAR(v.statistics[0].gap.estimate, 0, 1e-12);
  EXPECT_EQ(v.statistics[0].estimand, Estimand::kMedian);
  EXPECT_EQ(v.statistics.back().estimand, Estimand::kMean) << "outcomes are of all runs, as they end";
  EXPECT_EQ(v.statistics.back().word, Word::kDiffers);
  EXPECT_EQ(v.word, Word::kDiffers);
  ASSERT_TRUE(v.cut.has_value());
  EXPECT_EQ(v.cut->pairs, 12U);
  EXPECT_NEAR(v.cut->mean_s, 3.5, 1e-12);
  EXPECT_NEAR(v.cut->shortest_s, 2, 1e-12);
  EXPECT_NEAR(v.cut->difference_s.estimate, -1.5, 1e-12);
  EXPECT_EQ(v.outcomes_b[static_cast<std::size_t>(Outcome::kFell)], 12U);
}

// A robot that stays where it is has no heading, which leaves nothing unresolved.
TEST(ReachVerdicts, StatisticsThatNoRunHasAreNoneOfIt) {
  const MadeUp truth{[](const Engine&, const Variation&, std::size_t) { return 1.0; }};
  Behaviour behaviour = truth.behaviour();
  behaviour.statistics.push_back({"heading", "heading", "rad", {0, 0.1, false, "stated"}});
  const auto with_heading = [&truth, behaviour](bool of_one) {
    Behaviour b = behaviour;
    b.run = [run = truth.behaviour().run, of_one](const Engine& e, const Variation& v, std::size_t k,
                                                  double h) {
      BehaviourRun result = run(e, v, k, h);
      result.values.push_back(of_one && e.name() == "b" ? std::optional(1.0) : std::nullopt);
      return result;
    };
    return reach_verdicts(b, kTwo, {}).pairs.front();
  };
  const Verdict none = with_heading(false);
  EXPECT_EQ(none.word, Word::kAgrees) << describe(none);
  ASSERT_EQ(none.undefined.size(), 1U);
  EXPECT_EQ(none.undefined.front().key, "heading");
  EXPECT_EQ(none.statistics.size(), 2U);
  // A value that one engine alone has is a question.
  const Verdict one = with_heading(true);
  EXPECT_EQ(one.word, Word::kUnresolved);
  EXPECT_TRUE(one.undefined.empty());
}

TEST(ReachVerdicts, FallsAtHalfTheStepAreAFindingOfTheirOwn) {
  const MadeUp truth{[](const Engine&, const Variation&, std::size_t) { return 1.0; },
                     [](const Engine& e, const Variation& v, std::size_t) {
                       return e.name() == "b" && v.step < 1 ? 1.0 : kToTheEnd;
                     }};
  const Verdict v = reach_verdicts(truth.behaviour(), kTwo, {}).pairs.front();
  EXPECT_EQ(v.statistics[0].word, Word::kAgrees);
  EXPECT_EQ(v.statistics.back().word, Word::kStepDependent) << describe(v);
  EXPECT_EQ(v.word, Word::kStepDependent);
}

TEST(ReachVerdicts, RunsAQuarterOfTheStepWhereHalfOfItChangesAWord) {
  std::mutex mutex;
  std::set<std::string> seen;
  // Second order in the step: at none the engines are the same.
  MadeUp truth{[&](const Engine& e, const Variation& v, std::size_t k) {
    const std::scoped_lock lock(mutex);
    seen.insert(std::string(v.name));
    return 1 + (e.name() == "b" ? 0.1 * v.step * v.step + 1e-4 * by_start(k, 2) : 0);
  }};
  const Verdict v = reach_verdicts(truth.behaviour(), kTwo, {}).pairs.front();
  EXPECT_EQ(v.statistics[0].word, Word::kStepDependent);
  EXPECT_TRUE(seen.contains(std::string(quarter_step().name)));
  ASSERT_TRUE(v.statistics[0].step->extrapolated.has_value());
  EXPECT_NEAR(*v.statistics[0].step->extrapolated, 0, 1e-3);
  seen.clear();
  truth.speed = [&](const Engine&, const Variation& variation, std::size_t) {
    const std::scoped_lock lock(mutex);
    seen.insert(std::string(variation.name));
    return 1.0;
  };
  EXPECT_EQ(reach_verdicts(truth.behaviour(), kTwo, {}).pairs.front().word, Word::kAgrees);
  EXPECT_FALSE(seen.contains(std::string(quarter_step().name)));
}

TEST(ReachVerdicts, ShowWhatAnEngineThatDeclaresASettingChangesByItself) {
  const std::vector<Engine> engines{nothing("a", {.soft_friction = true}), nothing("b", {.sweeps = true})};
  const MadeUp truth{[](const Engine& e, const Variation& v, std::size_t) {
    return 1 + (v.impratio > 1 ? 0.2 : 0) + (v.iterations < 1 && e.name() == "b" ? 0.3 : 0);
  }};
  const Verdicts all = reach_verdicts(truth.behaviour(), engines, {});
  std::map<std::string, double> own;
  for (const OwnChange& change : all.pairs.front().statistics[0].own)
    own[change.engine + ", " + change.variation] = change.change.estimate;
  EXPECT_NEAR(own.at("a, ten times the impratio"), 1, 1e-12);
  EXPECT_NEAR(own.at("b, a tenth of the sweeps"), 1.5, 1e-12);
  EXPECT_FALSE(own.contains("b, ten times the impratio"));
  EXPECT_NEAR(own.at("a, half the time step"), 0, 1e-12);
  EXPECT_EQ(all.variations, (std::vector<std::string>{"as asked", "half the time step",
                                                      "ten times the impratio", "a tenth of the sweeps"}));
}

TEST(ReachVerdicts, EndAtTheFirstLookThatSettlesEveryPair) {
  std::atomic<std::size_t> most = 0;
  const MadeUp truth{[&](const Engine&, const Variation&, std::size_t k) {
    most = std::max<std::size_t>(most, k);
    return 1.0;
  }};
  const Verdicts settled = reach_verdicts(truth.behaviour(), kTwo, {.starts = 24, .looks = 3});
  EXPECT_EQ(settled.looks_made, 1U);
  EXPECT_EQ(settled.starts, 8U);
  EXPECT_EQ(most, 7U) << "the other starts are not run";
  const MadeUp open{[](const Engine& e, const Variation&, std::size_t k) {
    return 1 + (e.name() == "b" ? 0.08 * by_start(k, 3) : 0);
  }};
  const Verdicts looked = reach_verdicts(open.behaviour(), kTwo, {.starts = 24, .looks = 3});
  EXPECT_EQ(looked.looks_made, 3U);
  EXPECT_EQ(looked.starts, 24U);
  EXPECT_EQ(looked.pairs.front().word, Word::kUnresolved);
  EXPECT_TRUE(looked.pairs.front().starts_needed.has_value());
}

TEST(ReachVerdicts, SayWhatTheControlStepLeavesOut) {
  MadeUp truth{[](const Engine&, const Variation&, std::size_t) { return 1.0; }};
  Behaviour behaviour = truth.behaviour();
  behaviour.delays = {1.5e-3};  // no whole number of steps, nor of halves of them... of quarters
  behaviour.physics_dt = 2e-3;
  const Verdicts all = reach_verdicts(behaviour, kTwo, {});
  ASSERT_FALSE(all.left_out.empty());
  EXPECT_NE(all.left_out.front().find("whole number"), std::string::npos) << all.left_out.front();
}

TEST(ReachVerdicts, RefuseImpossibleOptions) {
  const Behaviour behaviour =
      MadeUp{[](const Engine&, const Variation&, std::size_t) { return 1.0; }}.behaviour();
  EXPECT_THROW(reach_verdicts(behaviour, kTwo, {.starts = 3}), ConfigError);
  EXPECT_THROW(reach_verdicts(behaviour, kTwo, {.looks = 0}), ConfigError);
  EXPECT_THROW(reach_verdicts(behaviour, kTwo, {.looks = 5}), ConfigError);
  EXPECT_THROW(reach_verdicts(behaviour, kTwo, {.confidence = 1}), ConfigError);
  EXPECT_THROW(reach_verdicts(behaviour, kTwo, {.failures = 0}), ConfigError);
  EXPECT_THROW(reach_verdicts(behaviour, std::span(kTwo).first(1), {}), ConfigError);
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
  options.starts = 6;
  options.workers = workers;
  const std::vector<Engine> engines{find_engine(a), find_engine(b)};
  return reach_verdicts(behaviour, engines, options).pairs.front();
}

TEST(ReachVerdicts, DoNotHangOnThreads) {
  const std::vector<std::string> names = available_engines();
  if (names.empty()) GTEST_SKIP() << "no engine is built in";
  const auto text = [&](std::size_t workers) {
    return to_json(short_trot(names.front(), names.back(), workers)).dump();
  };
  EXPECT_EQ(text(1), text(3));
}

TEST(ReachVerdicts, EnginesOfOneContactLawAgree) {
  std::vector<std::string> matched;
  for (const std::string& name : available_engines()) {
    if (find_engine(name).info.laws == find_engine(available_engines().front()).info.laws)
      matched.push_back(name);
  }
  if (matched.size() < 2) GTEST_SKIP() << "no two engines declare the same contact law";
  const Verdict verdict = short_trot(matched[0], matched[1], 1);
  EXPECT_EQ(verdict.word, Word::kAgrees) << describe(verdict);
  ASSERT_FALSE(verdict.statistics.empty());
  for (const StatisticVerdict& v : verdict.statistics) {
    if (v.statistic.key == "failures") continue;
    measured(v.statistic.name + ", gap in margins", v.gap.estimate / v.margin);
    // Measured 2.2e-9 (RMS roll) at the solver tolerance of everyday use; a hundred times that, and up.
    EXPECT_NEAR(v.gap.estimate / v.margin, 0, 1e-6) << v.statistic.name;
  }
}

}  // namespace
}  // namespace crossgait
