// What people and programs are told of verdicts and attributions, from numbers made by hand.
#include "parity/verdict_report.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "physics/core/schema.h"
#include "tests/support/table_rows.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

// Every number another one, so that none can be shown for another.
Verdict some_verdict() {
  Verdict v;
  v.behaviour = "trot on rough";
  v.a = "one";
  v.b = "two";
  v.options.starts = 7;
  v.options.limit = 1.5;
  v.options.confidence = 0.9;
  v.variations = {variations()[0], variations()[3]};
  v.left_out = {"twice the time step (reason)"};
  StatisticVerdict s;
  s.statistic = {"distance", "m", 0.02, 0.005};
  s.mean_a = 0.5;
  s.mean_b = 0.25;
  s.gap = {-0.25, -0.3125, -0.1875};
  s.spread_a = {3, 4, 12};
  s.spread_b = {2, 3, 6};
  s.spread = 0.125;
  s.floor = 0.0625;
  s.score = {-1.75, -2.5, -1.25};
  s.value = VerdictValue::kUnresolved;
  v.statistics.push_back(s);
  s = {};
  s.statistic = {"duty factor", "-", 0, 0.02};
  s.value = VerdictValue::kAgrees;
  v.statistics.push_back(s);
  return v;
}

TEST(VerdictReport, HasALineForEveryStatisticAndTheRule) {
  const std::vector<Cells> rows = table_rows(describe(some_verdict()));
  EXPECT_EQ(
      rows,
      (std::vector<Cells>{
          {"trot on rough", "one", "two", "gap", "+-", "spread", "floor", "score", "from", "to", "verdict"},
          {"distance, m", "0.5", "0.25", "-0.25", "0.0625", "0.125", "0.0625", "-1.75", "-2.50", "-1.25",
           "unresolved"},
          {"duty factor", "0", "0", "+0", "0", "0", "0", "+0.00", "+0.00", "+0.00", "agrees"},
          {"7 starts; as asked, loose solver."},
          {"Score = gap / sqrt(spread^2 + floor^2), at 90 % confidence for all lines together: "
           "agrees within +-1.5,"},
          {"engine-dependent beyond, unresolved across."},
          {"Left out: twice the time step (reason)."},
          {"two against one: unresolved."}}));
}

TEST(VerdictReport, AsJsonHasEveryNumber) {
  const ordered_json json = to_json(some_verdict());
  const ordered_json statistic = {
      {"name", "distance"},
      {"unit", "m"},
      {"mean_a", 0.5},
      {"mean_b", 0.25},
      {"gap", {{"estimate", -0.25}, {"low", -0.3125}, {"high", -0.1875}}},
      {"spread_a", {{"starts", 3.0}, {"time_step", 4.0}, {"solver", 12.0}, {"total", 13.0}}},  // 9 + 16 + 144
      {"spread_b", {{"starts", 2.0}, {"time_step", 3.0}, {"solver", 6.0}, {"total", 7.0}}},
      {"spread", 0.125},
      {"floor", 0.0625},
      {"score", {{"estimate", -1.75}, {"low", -2.5}, {"high", -1.25}}},
      {"verdict", "unresolved"}};
  ASSERT_EQ(json["statistics"].size(), 2U);
  EXPECT_EQ(json["statistics"][0].dump(1), statistic.dump(1));
  EXPECT_EQ(json["statistics"][1]["verdict"], "agrees");
  ordered_json rest = json;
  rest.erase("statistics");
  EXPECT_EQ(rest, (ordered_json{{"behaviour", "trot on rough"},
                                {"a", "one"},
                                {"b", "two"},
                                {"verdict", "unresolved"},
                                {"starts", 7},
                                {"limit", 1.5},
                                {"confidence", 0.9},
                                {"variations", {"as asked", "loose solver"}},
                                {"left_out", {"twice the time step (reason)"}}}));
}

TEST(AuditReport, AsJsonIsAList) {
  EXPECT_EQ(to_json(std::vector<AuditFinding>{}).dump(), "[]");
  EXPECT_EQ(to_json(std::vector<AuditFinding>{{"mass", "body trunk", 0.5, 0.25, "kg"}}).dump(),
            R"([{"quantity":"mass","element":"body trunk","a":0.5,"b":0.25,"unit":"kg"}])");
}

TEST(AuditReport, InWordsHasEveryFindingOrWhatWasLookedAt) {
  EXPECT_EQ(describe(std::vector<AuditFinding>{{"mass", "body trunk", 0.5, 0.25, "kg"},
                                               {"joint axis", "joint hip", 1, 0, "-"},
                                               {"time step", "", 1e-3, 2e-3, "s"}}),
            "mass, body trunk: 0.5 against 0.25 kg; joint axis, joint hip: 1 against 0; "
            "time step: 0.001 against 0.002 s");
  const std::string same = describe(std::vector<AuditFinding>{});
  EXPECT_TRUE(same.starts_with("the same in time step, mass, ")) << same;
  for (const std::string& quantity : audited_quantities())
    EXPECT_NE(same.find(quantity), std::string::npos) << quantity;
}

// From one to two by two factors: the distance shrinks by .5, the duty factor hardly changes.
Attribution some_attribution() {
  Attribution a;
  a.behaviour = "trot";
  a.from = "one";
  a.to = "two";
  a.statistics = {{"distance", "m", 0.02, 0.005}, {"duty factor", "-", 0, 0.02}};
  a.starts = 9;
  a.from_mean = {1.5, 0.625};
  a.to_mean = {1, 0.6125};
  a.gap = {{-0.5, -0.75, -0.25}, {-0.0125, -0.02, 0}};
  a.floor = {0.025, 0.02};
  FactorEffect big, small;
  big.factor = {"surface", "how the ground gives", {}};
  big.effect = {{-0.375, -0.5, -0.25}, {0, 0, 0}};
  big.step = {{-0.25, 0, 0}, {-0.0125, 0, 0}};
  big.first = {{-0.125, 0, 0}, {0, 0, 0}};
  big.last = {{-0.0625, 0, 0}, {0, 0, 0}};
  big.first_divergence = FirstDivergence{"load", 0.25, 1e-3};
  small.factor = {"cone", "the shape of friction", {"surface"}};
  small.effect = {{0.125, 0, 0.25}, {0, 0, 0}};
  small.step = {{-0.25, 0, 0}, {0, 0, 0}};
  small.first = small.last = {{0, 0, 0}, {0, 0, 0}};
  a.effects = {big, small};
  return a;
}

TEST(AttributionReport, HasFactorsTheWayAndTheShares) {
  EXPECT_EQ(table_rows(describe(some_attribution())),
            (std::vector<Cells>{{"From one to two, 9 starts:"},
                                {"surface", "how the ground gives"},
                                {"cone", "the shape of friction"},
                                {"one after the other", "distance, m", "duty factor"},
                                {"one", "1.5", "0.625"},
                                {"+ surface", "1.25", "0.6125"},
                                {"+ cone", "1", "0.6125"},
                                {"The last line is two."},
                                // Of a gap of -.5, positive where a factor makes it wider; not of one below
                                // its floor.
                                {"share of the gap, %", "distance, m", "first to part"},
                                {"surface", "+75 +- 25", "load at 0.250 s"},
                                {"cone", "-25 +- 25", "nothing"},
                                {"distance: surface."}}));
}

TEST(AttributionReport, SaysSoWhereNothingCanBeBlamed) {
  Attribution a = some_attribution();
  for (FactorEffect& e : a.effects) e.effect[0] = {0.25, -0.5, 1};
  EXPECT_EQ(table_rows(describe(a)).back(), Cells{"distance: no single factor."});
  // A gap of just the floor is one that somebody would act on.
  a.floor[1] = 0.0125;
  EXPECT_EQ(table_rows(describe(a)).back(), Cells{"duty factor: no single factor."});
  a.gap[0].estimate = a.gap[1].estimate = 0.001;
  EXPECT_EQ(table_rows(describe(a)).back(), Cells{"No gap is large enough to explain."});
}

TEST(AttributionReport, SharesOfAGapAreItsSignToo) {
  Attribution a = some_attribution();
  a.gap[0] = {0.5, 0.25, 0.75};
  const std::vector<Cells> rows = table_rows(describe(a));
  ASSERT_EQ(rows.size(), 12U);
  EXPECT_EQ(rows[9], (Cells{"surface", "-75 +- 25", "load at 0.250 s"}));
}

TEST(AttributionReport, AsJsonHasEveryNumber) {
  const ordered_json json = to_json(some_attribution());
  EXPECT_EQ(json["behaviour"], "trot");
  EXPECT_EQ(json["from"], "one");
  EXPECT_EQ(json["to"], "two");
  EXPECT_EQ(json["starts"], 9);
  ASSERT_EQ(json["statistics"].size(), 2U);
  const ordered_json nil = {{"estimate", 0.0}, {"low", 0.0}, {"high", 0.0}};
  const auto alone = [](double estimate) {
    return ordered_json{{"estimate", estimate}, {"low", 0.0}, {"high", 0.0}};
  };
  const ordered_json expected = {{"name", "distance"},
                                 {"unit", "m"},
                                 {"mean_from", 1.5},
                                 {"mean_to", 1.0},
                                 {"gap", {{"estimate", -0.5}, {"low", -0.75}, {"high", -0.25}}},
                                 {"floor", 0.025},
                                 {"leading", {"surface"}},
                                 {"factors",
                                  {{{"name", "surface"},
                                    {"effect", {{"estimate", -0.375}, {"low", -0.5}, {"high", -0.25}}},
                                    {"first", alone(-0.125)},
                                    {"last", alone(-0.0625)},
                                    {"step", alone(-0.25)}},
                                   {{"name", "cone"},
                                    {"effect", {{"estimate", 0.125}, {"low", 0.0}, {"high", 0.25}}},
                                    {"first", nil},
                                    {"last", nil},
                                    {"step", alone(-0.25)}}}}};
  EXPECT_EQ(json["statistics"][0].dump(1), expected.dump(1));
  EXPECT_EQ(
      json["factors"].dump(),
      R"([{"name":"surface","summary":"how the ground gives","needs":[],)"
      R"("first_divergence":{"quantity":"load","time_s":0.25,"tolerance":0.001}},)"
      R"({"name":"cone","summary":"the shape of friction","needs":["surface"],"first_divergence":null}])");
}

TEST(Schema, IsPutFirstAndHasToBeKnown) {
  EXPECT_EQ(with_schema("walk", {{"a", 1}}).dump(), R"({"schema":{"name":"walk","version":"draft"},"a":1})");
  EXPECT_THROW((void)schema("no such"), std::logic_error);
}

}  // namespace
}  // namespace crossgait
