// Shares against cooperative games that can be solved by hand.
#include "parity/attribution.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "parity/verdict_report.h"
#include "physics/core/error.h"

namespace crossgait {
namespace {

// Stands for an engine: the game's value is handed over when it is "built".
thread_local double value = 0;

using Game = std::function<double(bool a, bool b, bool c)>;

EngineFamily family_of(const Game& game, bool c_needs_b = false, const std::string& group_of_b_and_c = "") {
  EngineFamily family;
  family.from = "from";
  family.to = "to";
  family.factors = {{"a", "", {}}, {"b", "", {}}, {"c", "", {}}};
  if (c_needs_b) family.factors[2].needs = {"b"};
  family.factors[1].group = family.factors[2].group = group_of_b_and_c;
  family.with = [game](const std::vector<std::string>& names) -> Engine {
    const auto has = [&](const char* name) {
      return std::find(names.begin(), names.end(), name) != names.end();
    };
    return {{}, [result = game(has("a"), has("b"), has("c"))](const WorldSpec&) {
              value = result;
              return std::unique_ptr<PhysicsBackend>();
            }};
  };
  return family;
}

// The game's value plus the number of the start, which every set of factors shares.
Behaviour play() {
  Behaviour behaviour;
  behaviour.name = "game";
  behaviour.statistics = {{"value", "value", "-", {0, 0.1, false, ""}}};
  behaviour.seconds = 5;
  behaviour.cut_dt = 0.1;
  behaviour.run = [](const Engine& engine, const Variation&, std::size_t start, double) {
    engine.make(WorldSpec{});
    return BehaviourRun{{value + static_cast<double>(start)}, Outcome::kWalked, 5};
  };
  return behaviour;
}

std::vector<double> effects(const Attribution& attribution) {
  std::vector<double> result;
  for (const FactorEffect& e : attribution.effects) result.push_back(e.effect[0].estimate);
  return result;
}

void expect_near(const std::vector<double>& actual, const std::vector<double>& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i) EXPECT_NEAR(actual[i], expected[i], 1e-12) << i;
}

TEST(Attribute, ShareOutWhatTwoMakeTogether) {
  // 3 a + 2 b + 4 a b: each gets its own and half of the rest.
  const Attribution result =
      attribute(play(), family_of([](bool a, bool b, bool) { return 3.0 * a + 2.0 * b + 4.0 * (a && b); }),
                {.starts = 4});
  expect_near(effects(result), {5, 4, 0});
  EXPECT_NEAR(result.effects[0].first[0].estimate, 3, 1e-12);
  EXPECT_NEAR(result.effects[0].last[0].estimate, 7, 1e-12);
  EXPECT_NEAR(result.effects[1].step[0].estimate, 6, 1e-12);
  EXPECT_NEAR(result.gap[0].estimate, 9, 1e-12);
  EXPECT_EQ(result.cause(0).leading, std::vector<std::string>{"a"});
  EXPECT_EQ(result.cause(0).sentence, "of +9: a +5, b +4");
}

TEST(Attribute, ShareOutWhatThreeMakeTogether) {
  const Attribution result =
      attribute(play(), family_of([](bool a, bool b, bool c) { return 6.0 * (a && b && c); }), {.starts = 4});
  expect_near(effects(result), {2, 2, 2});
  EXPECT_EQ(result.cause(0).leading.size(), 3U);
}

TEST(Attribute, GoesOnlyByOrdersThatHaveMeaning) {
  // c needs b: orders abc, bac, bca. 6 a c + 3 c: c adds 9, 9 and 3 then; a 0, 0 and 6.
  const auto game = [](bool a, bool b, bool c) {
    EXPECT_TRUE(b || !c);
    return 6.0 * (a && c) + 3.0 * c;
  };
  const Attribution result = attribute(play(), family_of(game, true), {.starts = 4});
  expect_near(effects(result), {2, 0, 7});
  EXPECT_NEAR(result.effects[1].last[0].estimate, 0, 1e-12);  // before c, which needs it
}

// b and c are one decision: orders abc, acb, bca, cba. a b c comes with a last (twice of four), and with the
// second of b and c otherwise.
TEST(Attribute, PutsInTheFactorsOfAGroupOneAfterTheOther) {
  const auto game = [](bool a, bool b, bool c) { return 6.0 * (a && b && c); };
  const Attribution result = attribute(play(), family_of(game, false, "law"), {.starts = 4});
  expect_near(effects(result), {3, 1.5, 1.5});
  ASSERT_EQ(result.groups.size(), 2U);
  EXPECT_EQ(result.groups[1].name, "law");
  EXPECT_NEAR(result.groups[1].effect[0].estimate, 3, 1e-12);
  EXPECT_EQ(result.cause(0).leading, (std::vector<std::string>{"a", "law"}));
  ASSERT_TRUE(result.interactions[0].has_value());
  EXPECT_NEAR(result.interactions[0]->amount, 6, 1e-12);
}

// Half a decision may go the other way than its whole, and what opposes a gap is never its cause.
TEST(Attribute, BlamesNothingThatOpposesTheGap) {
  const auto game = [](bool a, bool b, bool c) { return 1.0 * a - 4.0 * b + 4.5 * c; };
  const Attribution alone = attribute(play(), family_of(game), {.starts = 4});
  EXPECT_EQ(alone.cause(0).kind, Cause::Kind::kNoSingle);
  EXPECT_TRUE(alone.cause(0).leading.empty());
  EXPECT_NE(alone.cause(0).sentence.find("+5.5 and -4 nearly cancel"), std::string::npos)
      << alone.cause(0).sentence;
  const Attribution grouped = attribute(play(), family_of(game, false, "law"), {.starts = 4});
  EXPECT_EQ(grouped.cause(0).kind, Cause::Kind::kLeading);
  EXPECT_EQ(grouped.cause(0).leading, std::vector<std::string>{"a"});
  EXPECT_EQ(grouped.cause(0).sentence, "of +1.5: a +1, law +0.5");
  const auto against = [](bool a, bool b, bool) { return -3.0 * a + 2.0 * b; };
  EXPECT_EQ(attribute(play(), family_of([&](bool a, bool b, bool c) { return -0.5 * against(a, b, c); }),
                      {.starts = 4})
                .cause(0)
                .kind,
            Cause::Kind::kNoSingle);
}

// Most of the gap is an effect that may be none, and a small one is known well.
TEST(Attribute, BlamesNoSmallEffectForALargeOneThatIsUncertain) {
  Attribution result;
  result.statistics = {{"value", "value", "-", {0, 0.1, false, ""}}};
  result.margin = {0.1};
  result.interactions = {std::nullopt};
  result.gap = {{1, 0.5, 1.5}};
  result.groups = {{"large", {0}, {{0.8, -0.1, 1.7}}}, {"small", {1}, {{0.2, 0.1, 0.3}}}};
  const Cause uncertain = result.cause(0);
  EXPECT_EQ(uncertain.kind, Cause::Kind::kNoSingle);
  EXPECT_TRUE(uncertain.leading.empty());
  EXPECT_EQ(uncertain.sentence,
            "of +1: large +0.8, small +0.2, the largest of which cannot be told from zero");
  result.groups[0].effect[0].low = 0.1;
  EXPECT_EQ(result.cause(0).leading.front(), "large");
}

// Falls with a: the share of failures has a cause, too, and all runs of a start are cut at the first.
TEST(Attribute, SaysWhatMakesRunsFail) {
  Behaviour behaviour = play();
  behaviour.run = [](const Engine& engine, const Variation&, std::size_t, double horizon) {
    engine.make(WorldSpec{});
    const double seconds = std::min(value > 2 ? 1.0 : 5.0, horizon);
    return BehaviourRun{{seconds}, value > 2 && horizon > 1 ? Outcome::kFell : Outcome::kWalked, seconds};
  };
  const Attribution result =
      attribute(behaviour, family_of([](bool a, bool b, bool) { return 3.0 * a + 0.5 * b; }), {.starts = 4});
  EXPECT_EQ(result.statistics.back().key, "failures");
  EXPECT_EQ(result.cause(1).leading, std::vector<std::string>{"a"});
  EXPECT_NEAR(result.gap[0].estimate, 0, 1e-12) << "over the same second";
}

TEST(Attribute, NamesNothingWhereThereIsNothing) {
  const Attribution result =
      attribute(play(), family_of([](bool a, bool, bool) { return 0.05 * a; }), {.starts = 4});
  EXPECT_TRUE(result.cause(0).leading.empty());
  EXPECT_NE(describe(result).find("No gap is large enough"), std::string::npos);
}

TEST(Attribute, DoesNotHangOnThreads) {
  const Game game = [](bool a, bool b, bool c) { return 3.0 * a + 2.0 * b + 4.0 * (a && c); };
  EXPECT_EQ(effects(attribute(play(), family_of(game), {.starts = 4, .workers = 1})),
            effects(attribute(play(), family_of(game), {.starts = 4, .workers = 3})));
}

TEST(Attribute, RefusesFamiliesWithoutMeaning) {
  const Game game = [](bool, bool, bool) { return 0.0; };
  EngineFamily family = family_of(game);
  family.factors[0].needs = {"c"};
  EXPECT_THROW(attribute(play(), family, {}), ConfigError);
  family = family_of(game);
  family.factors[0].group = family.factors[2].group = "not side by side";
  EXPECT_THROW(attribute(play(), family, {}), ConfigError);
  family.factors.clear();
  EXPECT_THROW(attribute(play(), family, {}), ConfigError);
  EXPECT_THROW(attribute(play(), family_of(game), {.starts = 3}), ConfigError);
}

}  // namespace
}  // namespace crossgait
