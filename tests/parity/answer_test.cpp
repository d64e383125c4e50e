// What comparisons come to, word for word, from numbers made by hand.
#include "parity/answer.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace crossgait {
namespace {

WalkRun run_in(const std::string& engine, const std::string& library, const std::string& law, double distance,
               Outcome outcome = Outcome::kWalked) {
  WalkRun run;
  run.engine.name = engine;
  run.engine.library = library;
  run.engine.laws.contact = law;
  run.terrain = "slope";
  run.gait = "pace";
  run.summary.distance_m = distance;
  run.summary.outcome = outcome;
  run.summary.simulated_seconds = 6;
  run.summary.physics_steps = 6000;
  return run;
}

PairDifference apart(const std::string& a, const std::string& b, double metres) {
  PairDifference pair;
  pair.a = a;
  pair.b = b;
  pair.max_position_difference_m = metres;
  return pair;
}

// Two codes under one law do the same, and one of them under its own something else.
Comparison two_laws() {
  Comparison c;
  c.leg_length_m = 0.2;
  c.runs = {run_in("one", "One", "soft", 1.0192), run_in("two:soft", "Two", "soft", 1.0192),
            run_in("two", "Two", "hard", -1.534, Outcome::kSlid)};
  c.pairs = {apart("one", "two:soft", 1.3e-10), apart("one", "two", 2.7), apart("two:soft", "two", 2.7)};
  c.pairs[0].same_laws = true;
  c.pairs[0].one_step = OneStepDifference{4e-12, 0, 0, 1, 3000};
  RobotState a, b;
  b.p_WB.z() = 0.005;
  c.pairs[1].parting = PartingWatch(c.leg_length_m);
  c.pairs[1].parting.add(a, b);
  a.time = 0.75;
  b.p_WB.x() = 1;
  c.pairs[1].parting.add(a, b);
  return c;
}

TEST(Answer, EnumeratesAsPeopleDo) {
  EXPECT_EQ(listed({}), "");
  EXPECT_EQ(listed({"a"}), "a");
  EXPECT_EQ(listed({"a", "b"}), "a and b");
  EXPECT_EQ(listed({"a", "b", "c"}), "a, b and c");
  EXPECT_EQ(group_name(0), "A");
  EXPECT_EQ(group_name(25), "Z");
  EXPECT_EQ(group_name(26), "AA");
  EXPECT_EQ(group_name(27 * 26), "AAA");
}

TEST(Answer, SaysWhatCameOutWhereAndThatTheLawDecides) {
  EXPECT_EQ(
      summary(two_laws()),
      "pace on slope walked 1.02 m in one and two:soft, but slid 1.53 m back in two. It is the contact law, "
      "not the code: two:soft is Two under one's law, and did what one did.");
}

TEST(Answer, DoesNotNameTheLawWhereTheOutcomesAreAlike) {
  Comparison c = two_laws();
  c.runs[2].summary = c.runs[0].summary;
  c.runs[2].summary.distance_m = 1.05;
  EXPECT_EQ(summary(c), "pace on slope walked 1.02 to 1.05 m in all 3 engines, up to 2.7 m apart.");
  c.runs.pop_back();
  c.pairs.resize(1);
  EXPECT_EQ(summary(c), "pace on slope walked 1.02 m in one and two:soft, the same to 1.3e-10 m.");
  c.runs[1].summary.distance_m = 0.5;
  c.pairs[0].max_position_difference_m = 0.52;
  EXPECT_EQ(summary(c), "pace on slope walked 1.02 m in one and 0.5 m in two:soft, up to 0.52 m apart.");
}

TEST(Answer, GroupsRunsThatDidTheSame) {
  const Comparison c = two_laws();
  const std::vector<RunGroup> groups = groups_of(c);
  ASSERT_EQ(groups.size(), 2U);
  EXPECT_EQ(groups[0].runs, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(groups[0].from_first, nullptr);
  EXPECT_EQ(groups[1].runs, std::vector<std::size_t>{2});
  EXPECT_EQ(groups[1].from_first, &c.pairs[1]);
  EXPECT_EQ(
      describe_groups(c),
      (std::vector<std::string>{
          "A = one, two:soft: walked 1.02 m, the same to 1.3e-10 m",
          "B = two: slid 1.53 m back; 2.7 m from A at most; 5 mm of that as they stand; parted at 0.75 s"}));
  EXPECT_EQ(describe_parity(c),
            (std::vector<std::string>{"Parted: moved to one another by more than 5 % of a leg length (10 "
                                      "mm), or turned by 0.05 rad, since "
                                      "they stood.",
                                      "Same laws: one and two:soft. One control step from the same state: "
                                      "4e-12 m or rad apart at most."}));
  const nlohmann::ordered_json json = groups_json(c);
  ASSERT_EQ(json.size(), 2U);
  EXPECT_EQ(json[1]["name"], "B");
  EXPECT_EQ(json[1]["engines"], nlohmann::ordered_json::array({"two"}));
  EXPECT_EQ(json[1]["outcome"], "slid");
  EXPECT_EQ(json[0]["apart_m"], 1.3e-10);
}

TEST(Answer, HoldsApartWhatDiffersInAnyWay) {
  const auto groups = [](auto change) {
    Comparison c = two_laws();
    change(c);
    return groups_of(c).size();
  };
  EXPECT_EQ(groups([](Comparison& c) { c.pairs[0].max_position_difference_m = 1.1e-6; }), 3U);
  EXPECT_EQ(groups([](Comparison& c) { c.pairs[0].max_joint_difference_rad = 1.1e-6; }), 3U);
  EXPECT_EQ(groups([](Comparison& c) { c.pairs[0].max_attitude_difference_rad = 1.1e-6; }), 3U);
  EXPECT_EQ(groups([](Comparison& c) { --c.runs[1].summary.physics_steps; }), 3U) << "it ended earlier";
  EXPECT_EQ(groups([](Comparison& c) { c.pairs.erase(c.pairs.begin()); }), 3U) << "nothing is known";
  // Near to one of a group is not near to all of it.
  EXPECT_EQ(groups([](Comparison& c) { c.pairs[1].max_position_difference_m = 1e-7; }), 2U);
}

TEST(Answer, TellsOutcomesWithTheNumberThatBelongsToThem) {
  MotionSummary m;
  m.distance_m = 0.3125;
  EXPECT_EQ(outcome_phrase(m), "walked 0.312 m");  // 0.3125 is a binary fraction: to even
  m.lateral_m = -0.5;
  m.outcome = Outcome::kStrayed;
  EXPECT_EQ(outcome_phrase(m), "strayed 0.5 m to the right");
  m.lateral_m = 0;
  m.distance_m = -0.25;
  m.outcome = Outcome::kBackward;
  EXPECT_EQ(outcome_phrase(m), "went 0.25 m back");
  m.outcome = Outcome::kNoProgress;
  EXPECT_EQ(outcome_phrase(m), "made no progress (0.25 m back)");
  m.outcome = Outcome::kFell;
  m.first_at_s[static_cast<std::size_t>(Outcome::kFell)] = 1.67;
  EXPECT_EQ(outcome_phrase(m), "fell at 1.67 s");
  m.outcome = Outcome::kWalked;
  m.distance_m = 0.02;
  m.yaw_rad = 1.5;
  EXPECT_EQ(outcome_phrase(m), "walked 0.02 m and ended 86 deg to the left of its heading");
}

TEST(Answer, OfThreeOutcomesEnumeratesThem) {
  Comparison c = two_laws();
  c.runs[1].summary.outcome = Outcome::kFell;
  c.runs[1].summary.first_at_s[static_cast<std::size_t>(Outcome::kFell)] = 1.5;
  c.pairs[0].max_position_difference_m = 0.5;
  EXPECT_EQ(summary(c),
            "pace on slope walked 1.02 m in one, fell at 1.50 s in two:soft and slid 1.53 m back in two.");
}

TEST(Answer, OfOneWalkIsASentence) {
  EXPECT_EQ(summary(run_in("one", "One", "soft", 1.0192)), "pace on slope walked 1.02 m in one (6 s).");
}

}  // namespace
}  // namespace crossgait
