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
  v.outcomes_a[static_cast<std::size_t>(Outcome::kWalked)] = 7;
  v.outcomes_b[static_cast<std::size_t>(Outcome::kWalked)] = 5;
  v.outcomes_b[static_cast<std::size_t>(Outcome::kFell)] = 2;
  v.cut = PairCut{2, true, 4.5, 1.25, 5, 4.75, {-0.25, -0.5, 0.125}};
  v.word = Word::kUnresolved;
  v.reason = "distance";
  v.starts_needed = 40;
  StatisticVerdict s;
  s.statistic = {"distance_m", "distance", "m", {0.02, 0.001, true, "by hand"}};
  s.value_a = 0.5;
  s.value_b = 0.25;
  s.pairs = 7;
  s.gap = {-0.25, -0.3125, -0.1875};
  s.equivalence = {-0.25, -0.28125, -0.21875};
  s.margin = 0.0625;
  s.step = StepCheck{{-0.375, -0.4375, -0.125}, {-0.125, -0.15625, -0.09375}, -0.4375, 1, -0.5};
  s.own = {{"one", "half the time step", {0.75, 0.625, 0.875}}};
  s.reason = "the interval crosses the margin";
  s.starts_needed = 40;
  v.statistics.push_back(s);
  s = {};
  s.statistic = {"duty_factor", "duty factor", "-", {0, 0.02, false, "by hand"}};
  s.word = Word::kAgrees;
  v.statistics.push_back(s);
  v.undefined.push_back({"heading_error_deg", "heading error", "deg", {}});
  return v;
}

TEST(VerdictReport, HasALineForEveryStatisticAndEveryReason) {
  EXPECT_EQ(table_rows(describe(some_verdict())),
            (std::vector<Cells>{
                {"statistic", "one", "two", "gap", "from", "to", "margin", "at half the step", "word"},
                {"distance, m", "0.5", "0.25", "-0.25", "-0.312", "-0.188", "0.0625", "-0.375", "unresolved"},
                {"duty factor", "0", "0", "+0", "+0", "+0", "0", "-", "agrees"},
                {"Outcomes: one: walked 7; two: walked 5, fell 2."},
                {"Of 2 pairs one run or both ended early: pairs are compared up to there, 4.50 s on average, "
                 "1.25 s "
                 "at least."},
                {"Runs lasted 5.00 s in one and 4.75 s in two: -0.25 s (-0.50 to +0.12)."},
                {"distance: unresolved: the interval crosses the margin; about 40 starts would tell."},
                {"With steps of one, a half and a quarter the gap in distance goes to -0.5 m, in order 1.0."},
                {"Without a value in any run: heading error."},
                {"by itself", "distance, m"},
                {"one, half the time step", "+0.75"}}));
}

TEST(VerdictReport, AsJsonHasEveryNumber) {
  const ordered_json json = to_json(some_verdict());
  const ordered_json statistic = {{"key", "distance_m"},
                                  {"name", "distance"},
                                  {"unit", "m"},
                                  {"values", {0.5, 0.25}},
                                  {"starts", 7},
                                  {"estimand", "mean"},
                                  {"gap", -0.25},
                                  {"low", -0.3125},
                                  {"high", -0.1875},
                                  {"equivalence", {{"low", -0.28125}, {"high", -0.21875}}},
                                  {"margin", 0.0625},
                                  {"margin_rule", {{"is", "2 % or 0.001 m a second"}, {"reason", "by hand"}}},
                                  {"word", "unresolved"},
                                  {"reason", "the interval crosses the margin"},
                                  {"starts_needed", 40},
                                  {"step",
                                   {{"gap_half", -0.375},
                                    {"low", -0.4375},
                                    {"high", -0.125},
                                    {"change", {{"estimate", -0.125}, {"low", -0.15625}, {"high", -0.09375}}},
                                    {"gap_quarter", -0.4375},
                                    {"order", 1.0},
                                    {"extrapolated", -0.5}}},
                                  {"own",
                                   {{{"engine", "one"},
                                     {"variation", "half the time step"},
                                     {"change", 0.75},
                                     {"low", 0.625},
                                     {"high", 0.875}}}}};
  ASSERT_EQ(json["statistics"].size(), 2U);
  EXPECT_EQ(json["statistics"][0].dump(1), statistic.dump(1));
  EXPECT_EQ(json["statistics"][1]["word"], "agrees");
  EXPECT_EQ(json["statistics"][1]["step"], nullptr);
  ordered_json rest = json;
  rest.erase("statistics");
  EXPECT_EQ(rest.dump(1),
            (ordered_json{{"engines", {"one", "two"}},
                          {"word", "unresolved"},
                          {"reason", "distance"},
                          {"starts_needed", 40},
                          {"cut",
                           {{"pairs", 2},
                            {"mean_s", 4.5},
                            {"shortest_s", 1.25},
                            {"time_to_failure",
                             {{"means_s", {5.0, 4.75}},
                              {"difference_s", {{"estimate", -0.25}, {"low", -0.5}, {"high", 0.125}}}}}}},
                          {"undefined", {"heading_error_deg"}}})
                .dump(1));
  EXPECT_EQ(to_json(some_verdict().outcomes_b).dump(), R"({"fell":2,"walked":5})");
  Verdict left = some_verdict();  // the terrain, and nothing else
  left.cut->any_failed = false;
  EXPECT_EQ(to_json(left)["cut"]["time_to_failure"], nullptr);
}

TEST(VerdictReport, SaysTheRule) {
  Verdicts verdicts;
  verdicts.starts = 7;
  verdicts.looks_made = 1;
  verdicts.options.looks = 2;
  verdicts.options.confidence = 0.9;
  verdicts.variations = {"as asked", "half the time step"};
  verdicts.left_out = {"a tenth of the sweeps: reason"};
  const std::string text = describe_rule(verdicts);
  for (const char* part : {"7 starts, look 1 of 2 that were planned", "as asked, half the time step",
                           "95 % interval", "90 % confidence", "Left out: a tenth of the sweeps: reason."})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
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
  EXPECT_EQ(describe(ModelAudit{{}, audited_quantities()}).find("not compared"), std::string::npos);
  ModelAudit audit{{}, audited_quantities()};
  std::erase(audit.compared, "contact law");
  const std::string same = describe(audit);
  EXPECT_TRUE(same.starts_with("the same in time step, mass, ")) << same;
  EXPECT_TRUE(same.ends_with(" (not compared: contact law)")) << same;
  audit.findings = {{"mass", "body trunk", 0.5, 0.25, "kg"}};
  EXPECT_EQ(describe(audit), "mass, body trunk: 0.5 against 0.25 kg (not compared: contact law)");
}

// From one to two by two factors: the distance shrinks by 0.5, the duty factor hardly changes.
Attribution some_attribution() {
  Attribution a;
  a.behaviour = "trot";
  a.from = "one";
  a.to = "two";
  a.statistics = {{"distance_m", "distance", "m", {}}, {"duty_factor", "duty factor", "-", {}}};
  a.starts = 9;
  a.from_mean = {1.5, 0.625};
  a.to_mean = {1, 0.6125};
  a.gap = {{-0.5, -0.75, -0.25}, {-0.0125, -0.02, 0}};
  a.margin = {0.025, 0.02};
  a.interactions.resize(2);
  a.has_traces = true;
  FactorEffect big, small;
  big.factor = {"hard", "how the ground gives", {}, nullptr, "rigid contact"};
  big.effect = {{-0.375, -0.5, -0.25}, {0, 0, 0}};
  big.step = {{-0.25, 0, 0}, {-0.0125, 0, 0}};
  big.first = {{-0.125, 0, 0}, {0, 0, 0}};
  big.last = {{-0.0625, 0, 0}, {0, 0, 0}};
  big.first_divergence = FirstDivergence{"load", 0.25, 1e-3};
  small.factor = {"cone", "the shape of friction", {"hard"}};
  small.effect = {{-0.125, -0.25, -0.0625}, {0, 0, 0}};
  small.step = {{-0.25, 0, 0}, {0, 0, 0}};
  small.first = small.last = {{0, 0, 0}, {0, 0, 0}};
  a.effects = {big, small};
  a.groups = {{"rigid contact", {0}, big.effect}, {"cone", {1}, small.effect}};
  return a;
}

TEST(AttributionReport, HasFactorsTheWayAndTheParts) {
  EXPECT_EQ(table_rows(describe(some_attribution())),
            (std::vector<Cells>{{"From one to two, 9 starts:"},
                                {"hard", "how the ground gives"},
                                {"cone", "the shape of friction"},
                                {"one after the other", "distance, m", "duty factor"},
                                {"one", "1.5", "0.625"},
                                {"+ hard", "1.25", "0.6125"},
                                {"+ cone", "1", "0.6125"},
                                {"The last line is two."},
                                // In the unit of the statistic; not of one below its margin.
                                {"part of the gap", "distance, m", "first to part"},
                                {"rigid contact", "-0.375 ± 0.12", "load at 0.250 s"},
                                {"cone", "-0.125 ± 0.094", "nothing"},
                                {"distance: of -0.5 m: rigid contact -0.375, cone -0.125."}}));
}

// What was not looked for is not said to be nothing.
TEST(AttributionReport, SaysNothingOfPartingWhereNothingWasRecorded) {
  Attribution a = some_attribution();
  a.has_traces = false;
  const std::vector<Cells> rows = table_rows(describe(a));
  EXPECT_EQ(rows[10], (Cells{"cone", "-0.125 ± 0.094", "-"}));
}

TEST(AttributionReport, ShowsTheHalvesOfADecision) {
  Attribution a = some_attribution();
  a.groups = {{"law", {0, 1}, {{-0.5, -0.75, -0.25}, {0, 0, 0}}}};
  const std::vector<Cells> rows = table_rows(describe(a));
  ASSERT_EQ(rows.size(), 13U);
  EXPECT_EQ(rows[9][0], "law");
  EXPECT_EQ(rows[10], (Cells{"of which hard", "-0.375 ± 0.12", "load at 0.250 s"}));
  EXPECT_EQ(rows[11], (Cells{"of which cone", "-0.125 ± 0.094", "nothing"}));
}

TEST(AttributionReport, SaysSoWhereNothingCanBeBlamed) {
  Attribution a = some_attribution();
  for (GroupEffect& group : a.groups) group.effect[0] = {-0.25, -0.5, 1};
  EXPECT_TRUE(a.cause(0).leading.empty());
  EXPECT_EQ(a.cause(0).kind, Cause::Kind::kNoSingle);
  a.gap[0].estimate = a.gap[1].estimate = 0.001;
  EXPECT_EQ(table_rows(describe(a)).back(), Cells{"No gap is large enough to explain."});
  EXPECT_EQ(a.cause(0).kind, Cause::Kind::kNothing);
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
  const ordered_json big = {{"estimate", -0.375}, {"low", -0.5}, {"high", -0.25}},
                     small = {{"estimate", -0.125}, {"low", -0.25}, {"high", -0.0625}};
  const ordered_json expected = {
      {"key", "distance_m"},
      {"name", "distance"},
      {"unit", "m"},
      {"mean_from", 1.5},
      {"mean_to", 1.0},
      {"gap", {{"estimate", -0.5}, {"low", -0.75}, {"high", -0.25}}},
      {"margin", 0.025},
      {"cause",
       {{"kind", "leading"},
        {"leading", {"rigid contact"}},
        {"sentence", "of -0.5 m: rigid contact -0.375, cone -0.125"}}},
      {"interaction", nullptr},
      {"factors",
       {{{"name", "hard"},
         {"effect", big},
         {"first", alone(-0.125)},
         {"last", alone(-0.0625)},
         {"step", alone(-0.25)}},
        {{"name", "cone"}, {"effect", small}, {"first", nil}, {"last", nil}, {"step", alone(-0.25)}}}},
      {"groups", {{{"name", "rigid contact"}, {"effect", big}}, {{"name", "cone"}, {"effect", small}}}}};
  EXPECT_EQ(json["statistics"][0].dump(1), expected.dump(1));
  EXPECT_EQ(
      json["factors"].dump(),
      R"([{"name":"hard","summary":"how the ground gives","needs":[],"group":"rigid contact",)"
      R"("first_divergence":{"quantity":"load","time_s":0.25,"tolerance":0.001}},)"
      R"({"name":"cone","summary":"the shape of friction","needs":["hard"],"group":"cone","first_divergence":null}])");
}

TEST(Schema, IsPutFirstAndHasToBeKnown) {
  EXPECT_EQ(with_schema("walk", {{"a", 1}}).dump(), R"({"schema":{"name":"walk","version":"draft"},"a":1})");
  EXPECT_THROW((void)schema("no such"), std::logic_error);
}

}  // namespace
}  // namespace crossgait
