// What people and programs are told of walks, word for word, from numbers made by hand.
#include "parity/report.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "parity/answer.h"
#include "tests/support/table_rows.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

void at(MotionSummary& m, Outcome outcome, double seconds) {
  m.first_at_s[static_cast<std::size_t>(outcome)] = seconds;
}

// Every number another one, so that none can be shown for another.
MotionSummary some_motion() {
  MotionSummary m;
  m.outcome = Outcome::kFell;
  at(m, Outcome::kFell, 1.25);
  at(m, Outcome::kLeftTerrain, 1.5);
  m.simulated_seconds = 2.5;
  m.physics_steps = 2500;
  m.distance_m = 0.3125;
  m.lateral_m = -0.0625;
  m.path_m = 0.375;
  m.yaw_rad = 0.15625;
  m.mean_speed_mps = 0.125;
  m.final_position_m = {3.25, 4.25, 5.25};
  m.rms_roll_deg = 1.125;
  m.rms_pitch_deg = 2.125;
  m.ik_clamped = 17;
  m.limit_factor = 0.875;
  m.max_penetration_m = 0.0015;
  m.max_loop_gap_m = 0.0025;
  m.duty_factor = {{0.5, 0.25, 0.75, 1}};
  m.slip_m = 0.4375;
  m.swing_contact_ratio = 0.0625;
  m.swing_contact_ratio_inner = 0.03125;
  m.slip_per_path = 0.1875;
  m.heading_error_deg = 6.5;
  m.cost_of_transport = 2.75;
  m.wall_seconds = 0.25;
  return m;
}

WalkRun some_walk(const std::string& engine, const MotionSummary& motion) {
  WalkRun run;
  run.engine.name = engine;
  run.engine.library = "Engine";
  run.engine.version = "1.2";
  run.terrain = "rough";
  run.gait = "trot";
  run.summary = motion;
  return run;
}

TEST(WalkReport, HasEveryStatistic) {
  EXPECT_EQ(table_rows(describe(some_walk("one", some_motion()))),
            (std::vector<Cells>{{"trot on rough fell at 1.25 s in one (2.5 s)."},
                                {"trot on rough, 2.5 s", "one"},
                                {"outcome", "fell at 1.25 s"},
                                {"simulated time, s", "2.50"},
                                {"distance, m", "0.3125"},
                                {"drift to the left, m", "-0.0625"},
                                {"mean speed, m/s", "0.1250"},
                                {"RMS roll, deg", "1.125"},
                                {"RMS pitch, deg", "2.125"},
                                {"duty factor, mean of legs", "0.625"},
                                {"swing contact, fraction", "0.062"},  // 0.0625 is a binary fraction: to even
                                {"swing contact, inner 80 %", "0.031"},
                                {"slip over planned stance path", "0.188"},
                                {"heading error, deg", "6.500"},
                                {"slip of loaded feet, m", "0.4375"},
                                {"largest penetration, mm", "1.500"},
                                {"largest loop gap, mm", "2.500"},
                                {"cost of transport", "2.750"},
                                {"IK targets clamped", "17"},
                                {"fraction of command followed", "0.875"},
                                {"wall time, s", "0.25"}}));
}

TEST(WalkReport, SaysWhenTheOutcomeWasAndNothingOfWhatIsNotKnown) {
  EXPECT_EQ(outcome_in_words(some_motion()), "fell at 1.25 s");
  EXPECT_EQ(outcome_in_words({}), "walked");
  MotionSummary slid;
  slid.outcome = Outcome::kSlid;
  EXPECT_EQ(outcome_in_words(slid), "slid");
  const std::vector<Cells> rows = table_rows(describe(some_walk("one", {})));
  for (const char* label : {"swing contact, fraction", "swing contact, inner 80 %",
                            "slip over planned stance path", "heading error, deg", "cost of transport"}) {
    EXPECT_EQ(std::count(rows.begin(), rows.end(), (Cells{label, "-"})), 1) << label;
  }
}

TEST(WalkReport, AsJsonHasEveryNumber) {
  WalkRun run = some_walk("one", some_motion());
  const ordered_json expected = {{"engine", "one"},
                                 {"engine_version", "Engine 1.2"},
                                 {"terrain", "rough"},
                                 {"gait", "trot"},
                                 {"contact", to_json(ContactSpec())},
                                 {"not_of_law", ordered_json::array()},
                                 {"outcome", "fell"},
                                 {"outcome_at_s", 1.25},
                                 {"simulated_seconds", 2.5},
                                 {"distance_m", 0.3125},
                                 {"lateral_m", -0.0625},
                                 {"path_m", 0.375},
                                 {"yaw_rad", 0.15625},
                                 {"fell", true},
                                 {"fell_at_s", 1.25},
                                 {"collapsed", false},
                                 {"left_terrain", true},
                                 {"loop_violated", false},
                                 {"diverged", false},
                                 {"mean_speed_mps", 0.125},
                                 {"final_position_m", {3.25, 4.25, 5.25}},
                                 {"rms_roll_deg", 1.125},
                                 {"rms_pitch_deg", 2.125},
                                 {"duty_factor", {{"FL", 0.5}, {"FR", 0.25}, {"RL", 0.75}, {"RR", 1.0}}},
                                 {"swing_contact_ratio", 0.0625},
                                 {"swing_contact_ratio_inner", 0.03125},
                                 {"slip_per_path", 0.1875},
                                 {"heading_error_deg", 6.5},
                                 {"slip_m", 0.4375},
                                 {"cost_of_transport", 2.75},
                                 {"ik_clamped", 17},
                                 {"limit_factor", 0.875},
                                 {"max_penetration_m", 0.0015},
                                 {"max_loop_gap_m", 0.0025},
                                 {"physics_steps", 2500},
                                 {"wall_seconds", 0.25}};
  EXPECT_EQ(to_json(run).dump(1), expected.dump(1));
  run.interrupted = true;
  EXPECT_EQ(to_json(run)["interrupted"], true);
}

TEST(WalkReport, SaysHowRobotAndGroundTouchWhereThatIsNotTheDefault) {
  WalkRun run = some_walk("one", some_motion());
  run.contact.friction = 0.4;
  EXPECT_EQ(describe(run).find("Contact:"), std::string::npos);  // friction has an option of its own
  run.contact.impratio = 100;
  run.contact.condim = 4;
  run.contact.cone = FrictionCone::kPyramidal;
  run.engine.capabilities.soft_friction = true;
  EXPECT_NE(describe(run).find("Contact: condim=4, impratio=100, cone=pyramidal; "
                               "not of the law of one: condim, cone.\n"),
            std::string::npos)
      << describe(run);
  const ordered_json json = to_json(run);
  EXPECT_EQ(json["contact"]["impratio"], 100);
  EXPECT_EQ(json["contact"]["cone"], "pyramidal");
  EXPECT_EQ(json["contact"]["solref"].dump(), "[0.02,1.0]");
  EXPECT_EQ(json["not_of_law"].dump(), R"(["condim","cone"])");
}

TEST(WalkReport, AsJsonSaysNullForWhatIsNotKnownAndTellsOutcomesApart) {
  const ordered_json json = to_json(MotionSummary{});
  for (const char* key : {"outcome_at_s", "fell_at_s", "swing_contact_ratio", "swing_contact_ratio_inner",
                          "slip_per_path", "heading_error_deg", "cost_of_transport"}) {
    ASSERT_TRUE(json.contains(key)) << key;
    EXPECT_TRUE(json[key].is_null()) << key;
  }
  const std::pair<Outcome, const char*> flags[] = {{Outcome::kFell, "fell"},
                                                   {Outcome::kCollapsed, "collapsed"},
                                                   {Outcome::kLeftTerrain, "left_terrain"},
                                                   {Outcome::kLoopViolated, "loop_violated"},
                                                   {Outcome::kDiverged, "diverged"}};
  for (const auto& [outcome, key] : flags) {
    MotionSummary m;
    at(m, outcome, 1);
    for (const auto& [other, name] : flags) EXPECT_EQ(to_json(m)[name], other == outcome) << key << name;
  }
}

Comparison some_comparison() {
  Comparison c;
  MotionSummary one = some_motion(), two = some_motion(), three = some_motion();
  two.distance_m = 0.375;  // a fifth more
  three.distance_m = -0.0005;
  c.runs = {some_walk("one", one), some_walk("two", two), some_walk("three", three)};
  PairDifference pair;
  pair.a = "one";
  pair.b = "two";
  pair.max_position_difference_m = 0.0123;
  pair.max_joint_difference_rad = 0.34;
  pair.max_attitude_difference_rad = 0.056;
  pair.first_divergence = FirstDivergence{"joint", 0.125, 1e-2};
  c.pairs.push_back(pair);
  pair.a = "three";
  pair.b = "one";
  pair.first_divergence->quantity = "position";
  c.pairs.push_back(pair);
  pair.same_laws = true;
  pair.tolerances.position = 1e-6;
  pair.tolerances.joint = 1e-5;
  pair.first_divergence.reset();
  pair.one_step = OneStepDifference{1e-12, 3e-12, 2e-12, 1.5, 1000};
  pair.growth = DifferenceGrowth{15, 0.5, 3, 1e-13, 1.4};
  c.pairs.push_back(pair);
  return c;
}

TEST(ComparisonReport, BeginsWithTheAnswerAndPutsGroupsSideBySide) {
  const Comparison c = some_comparison();
  const std::string text = describe(c);
  EXPECT_TRUE(text.starts_with(summary(c) + "\n\nA = one: ")) << text;
  const std::vector<Cells> rows = table_rows(text);
  const auto row = [&](const std::string& label) {
    const auto at =
        std::find_if(rows.begin(), rows.end(), [&](const Cells& r) { return r.front() == label; });
    return at == rows.end() ? Cells{} : *at;
  };
  EXPECT_EQ(row("trot on rough, 2.5 s"), (Cells{"trot on rough, 2.5 s", "A", "B", "C"}));
  EXPECT_EQ(row("distance, m"), (Cells{"distance, m", "0.3125", "0.3750", "-0.0005"}));
  EXPECT_EQ(describe(Comparison{}), "Nothing to compare.\n");
}

TEST(ComparisonReport, SaysSharesOfTwoGroupsWhereTheyMeanSomething) {
  Comparison c = some_comparison();
  c.runs.pop_back();
  c.pairs.resize(1);
  c.runs[1].summary.lateral_m = 0.0625;     // across zero
  c.runs[0].summary.max_loop_gap_m = 2e-7;  // shown as 0.000 mm
  const std::vector<Cells> rows = table_rows(describe(c));
  const auto has = [&](const Cells& row) { return std::count(rows.begin(), rows.end(), row) == 1; };
  EXPECT_TRUE(has({"trot on rough, 2.5 s", "A", "B", "B to A"}));
  EXPECT_TRUE(has({"distance, m", "0.3125", "0.3750", "+20.0 %"}));
  EXPECT_TRUE(has({"drift to the left, m", "-0.0625", "0.0625"})) << describe(c);
  EXPECT_TRUE(has({"largest loop gap, mm", "0.000", "2.500"})) << describe(c);
  EXPECT_TRUE(has({"RMS roll, deg", "1.125", "1.125"})) << "no share of no change";
}

TEST(ComparisonReport, AsJsonHasEveryRunAndPair) {
  const Comparison c = some_comparison();
  const ordered_json json = to_json(c);
  ASSERT_EQ(json["runs"].size(), 3U);
  EXPECT_EQ(json["runs"][2], to_json(c.runs[2]));
  ASSERT_EQ(json["pairs"].size(), 3U);
  const ordered_json expected = {
      {"a", "one"},
      {"b", "two"},
      {"same_laws", false},
      {"max_position_difference_m", 0.0123},
      {"max_joint_difference_rad", 0.34},
      {"max_attitude_difference_rad", 0.056},
      {"one_step", nullptr},
      {"growth", nullptr},
      {"first_divergence", {{"quantity", "joint"}, {"time_s", 0.125}, {"tolerance", 1e-2}}},
      {"standing_difference_m", 0.0},
      {"standing_difference_rad", 0.0},
      {"parted_at_s", nullptr}};
  EXPECT_EQ(json["pairs"][0].dump(1), expected.dump(1));
  EXPECT_EQ(json["pairs"][2]["same_laws"], true);
  EXPECT_TRUE(json["pairs"][2]["first_divergence"].is_null());
  EXPECT_EQ(json["pairs"][2]["one_step"]["joint_rad"], 3e-12);
  EXPECT_EQ(json["pairs"][2]["one_step"]["steps"], 1000);
  EXPECT_EQ(json["pairs"][2]["growth"]["per_half_second"], 15);
  EXPECT_EQ(json["summary"], summary(c));
  EXPECT_EQ(json["groups"], groups_json(c));
  EXPECT_EQ(to_json(Comparison{}).dump(),
            R"({"summary":"Nothing to compare.","groups":[],"parted_beyond_m":0.0,"runs":[],"pairs":[]})");
}

}  // namespace
}  // namespace crossgait
