#include "study/engine_comparison.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "parity/verdict_report.h"
#include "physics/core/error.h"
#include "physics/robot_files/data_path.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

BehaviourSpec short_trot() {
  WalkConfig config;
  config.timing = {.seconds = 0.2, .settle_seconds = 0.1};
  return {config, {}, 0};
}

BehaviourSpec short_policy() {
  PolicyConfig config;
  config.environment = std::get<WalkConfig>(short_trot().what).environment();
  return {config, {}, 0};
}

class EngineComparisons : public ScratchFolder {
 protected:
  void SetUp() override {
    ScratchFolder::SetUp();
    if (available_engines().size() < 2) GTEST_SKIP() << "one engine alone";
  }
  static std::string a() { return available_engines().front(); }
  // The last one that holds contacts by another law, if there is one.
  static std::string b() {
    const std::vector<std::string> all = available_engines();
    const auto other = std::find_if(all.rbegin(), all.rend(), [](const std::string& name) {
      return find_engine(name).info.laws.contact != find_engine(a()).info.laws.contact;
    });
    return other == all.rend() ? all.back() : *other;
  }
  JudgeOptions options(bool stored = false, std::size_t workers = 1) const {
    JudgeOptions o;
    o.verdict.starts = 4;
    o.verdict.workers = workers;
    if (stored) o.stored_runs = path("runs.jsonl");
    return o;
  }
  /// In both engines: as asked, half the step, and the settings that each declares.
  static long runs_a_start() {
    long count = 0;
    for (const std::string& name : {a(), b()}) {
      for (const Variation& v : variations())
        count += &v != &quarter_step() && v.of(find_engine(name).info) ? 1 : 0;
    }
    return count;
  }
  long lines() const {
    const std::string text = read(path("runs.jsonl"));
    return std::count(text.begin(), text.end(), '\n');
  }
};

TEST_F(EngineComparisons, AreAnAuditAndAVerdict) {
  for (const BehaviourSpec& spec : {short_trot(), short_policy()}) {
    const EngineComparison whole = judge_engines(spec, {a(), b()}, options());
    const std::vector<Engine> engines{find_engine(a()), find_engine(b())};
    const Verdicts verdicts = reach_verdicts(make_behaviour(spec), engines, options().verdict);
    EXPECT_EQ(to_json(whole.verdicts.pairs.front()).dump(), to_json(verdicts.pairs.front()).dump());
    const auto world_a = engines[0].make(LoadedBehaviour(spec).world()),
               world_b = engines[1].make(LoadedBehaviour(spec).world());
    const PairBackground& background = whole.backgrounds.front();
    EXPECT_EQ(to_json(background.models.findings).dump(),
              to_json(audit_models(*world_a, *world_b).findings).dump());
    EXPECT_EQ(background.shared, shared_parts(engines[0].info, engines[1].info));
    EXPECT_FALSE(background.attribution.has_value());
  }
}

TEST_F(EngineComparisons, ExplainWithTheFamilyOfTheTwoEngines) {
  if (engine_families().empty()) GTEST_SKIP() << "no engine is made of factors";
  JudgeOptions how = options(true);
  how.explain = true;
  BehaviourSpec spec = short_trot();
  const EngineFamily family = family_for(engine_families().front(), *LoadedBehaviour(spec).world().robot);
  std::get<WalkConfig>(spec.what).timing = {.seconds = 0.1, .settle_seconds = 0.05};
  const EngineComparison whole = judge_engines(spec, {family.from, family.to}, how);
  ASSERT_TRUE(whole.backgrounds.front().attribution.has_value());
  const Attribution attribution = attribute(make_behaviour(spec), family, {.starts = 4, .workers = 1});
  EXPECT_EQ(to_json(*whole.backgrounds.front().attribution).dump(), to_json(attribution).dump());
  // Every set of factors is an engine of its own to the store: the same again takes no run.
  const std::string bytes = read(path("runs.jsonl"));
  EXPECT_EQ(to_json(judge_engines(spec, {family.from, family.to}, how)).dump(), to_json(whole).dump());
  EXPECT_EQ(read(path("runs.jsonl")), bytes);
  // What would not matter is the same to causes as to words.
  how.verdict.margins["distance_m"] = {0, 0.5, false, "stated"};
  how.verdict.failures = 0.25;
  const EngineComparison wide = judge_engines(spec, {family.from, family.to}, how);
  const Attribution& with_margins = *wide.backgrounds.front().attribution;
  EXPECT_EQ(with_margins.statistics.front().key, "distance_m");
  EXPECT_EQ(with_margins.margin.front(), 0.5);
  EXPECT_EQ(with_margins.margin.back(), 0.25);
  EXPECT_THROW(judge_engines(spec, {family.to, family.to}, how), ConfigError);
}

TEST_F(EngineComparisons, FromStoredRunsCostNoRun) {
  for (const BehaviourSpec& spec : {short_trot(), short_policy()}) {
    std::filesystem::remove(path("runs.jsonl"));
    const std::string plain = to_json(judge_engines(spec, {a(), b()}, options())).dump();
    const std::string first = to_json(judge_engines(spec, {a(), b()}, options(true, 2))).dump();
    EXPECT_EQ(lines(), 4 * runs_a_start());
    const std::string bytes = read(path("runs.jsonl"));
    const std::string second = to_json(judge_engines(spec, {a(), b()}, options(true, 2))).dump();
    EXPECT_EQ(read(path("runs.jsonl")), bytes);  // what is made is added, so nothing was
    EXPECT_EQ(second, first);
    const auto without_workers = [](const std::string& text) {
      auto json = nlohmann::json::parse(text);
      json.erase("workers");
      return json;
    };
    EXPECT_EQ(without_workers(first), without_workers(plain));
  }
}

TEST_F(EngineComparisons, MoreStartsTakeOnlyTheRunsThatAreNew) {
  JudgeOptions how = options(true);
  judge_engines(short_trot(), {a(), b()}, how);
  const std::string bytes = read(path("runs.jsonl"));
  how.verdict.starts = 5;
  const EngineComparison more = judge_engines(short_trot(), {a(), b()}, how);
  EXPECT_EQ(more.starts_held, 4U) << "said, because whoever has looked at those looks again";
  EXPECT_EQ(lines(), 5 * runs_a_start());
  EXPECT_EQ(read(path("runs.jsonl")).substr(0, bytes.size()), bytes);
}

TEST_F(EngineComparisons, LookAtTheWorldOfThePolicysConfiguration) {
  PolicyConfig config;
  config.environment.robot = "scara_quadruped_long";
  config.environment.terrain = "rough:size_x=2,size_y=2";
  config.environment.terrain_seed = 9;
  config.environment.contact.add(friction_of(0.3));
  config.environment.physics_dt = 5e-4;
  const WorldSpec world = LoadedBehaviour(config, {}, 0).world();
  EXPECT_EQ(world.robot->name, "scara_quadruped_long");
  EXPECT_EQ(world.contact.friction, 0.3);
  EXPECT_EQ(world.physics_dt, 5e-4);
  const Terrain expected = make_terrain("rough:size_x=2,size_y=2", 9);
  EXPECT_EQ(world.terrain.name(), expected.name());
  for (const double x : {-0.7, 0.4, 0.8}) EXPECT_EQ(world.terrain.height(x, 0.5), expected.height(x, 0.5));
}

TEST_F(EngineComparisons, AuditThatWorldAndNoOther) {
  // By the first engine that holds something differently: friction of a pyramid is not the coefficient.
  PolicyConfig config;
  config.environment.robot = "scara_quadruped_long";
  config.environment.contact.add(friction_of(0.3));
  config.environment.episode_seconds = 0.02;
  config.environment.settle_seconds = 0;
  WorldSpec world;
  world.robot = std::make_shared<const RobotDescription>(load_robot(find_robot("scara_quadruped_long")));
  world.contact.friction = 0.3;
  const auto world_a = make_world(a(), world);
  std::vector<std::string> others = available_engines();
  for (const EngineFamily& family : engine_families()) {
    try {
      others.push_back(find_engine(family.to + "+pyramid").info.name);
    } catch (const ConfigError&) {  // an engine without one
    }
  }
  for (const std::string& other : others) {
    const auto world_b = make_world(other, world);
    const std::vector<AuditFinding> expected = audit_models(*world_a, *world_b).findings;
    if (expected.empty()) continue;
    const EngineComparison judged = judge_engines(LoadedBehaviour(config, {}, 0), {a(), other}, options());
    EXPECT_EQ(to_json(judged.backgrounds.front().models.findings).dump(), to_json(expected).dump()) << other;
    // A walk's defaults have another robot and a friction of 0.6.
    EXPECT_NE(
        to_json(judge_engines(short_trot(), {a(), other}, options()).backgrounds.front().models.findings)
            .dump(),
        to_json(expected).dump());
    return;
  }
  GTEST_SKIP() << "all engines hold the same";
}

TEST_F(EngineComparisons, StartWithNoRunWhereSomethingIsWrong) {
  JudgeOptions how = options(true);
  how.verdict.starts = 3;
  EXPECT_THROW(judge_engines(short_trot(), {a(), b()}, how), ConfigError);
  how = options(true);
  EXPECT_THROW(judge_engines(short_trot(), {a(), "nonsense"}, how), ConfigError);
  BehaviourSpec spec = short_policy();
  std::get<PolicyConfig>(spec.what).policy = "nonsense";
  EXPECT_THROW(judge_engines(spec, {a(), b()}, how), ConfigError);
  spec = short_trot();
  std::get<WalkConfig>(spec.what).terrain = "moon";
  EXPECT_THROW(judge_engines(spec, {a(), b()}, how), ConfigError);
  EXPECT_FALSE(std::filesystem::exists(path("runs.jsonl")));
}

EngineComparison by_hand() {
  EngineComparison c;
  c.engines = {{"one", "soft", "compliant"}, {"two", "hard", "rigid"}};
  c.verdicts.starts = 12;
  c.verdicts.engines = {"one", "two"};
  Verdict v;
  v.behaviour = "trot on flat, 5 s";
  v.a = "one";
  v.b = "two";
  v.outcomes_a[static_cast<std::size_t>(Outcome::kWalked)] = 12;
  v.outcomes_b = v.outcomes_a;
  const auto add = [&v](const char* key, const char* name, double gap, double margin, Word word) {
    StatisticVerdict s;
    s.statistic = {key, name, "m", {0, margin, false, ""}};
    s.gap.estimate = gap;
    s.margin = margin;
    s.word = word;
    v.statistics.push_back(s);
  };
  add("way_m", "way", 0.01, 0.02, Word::kAgrees);
  add("slip_m", "slip", -0.113, 0.02, Word::kDiffers);
  v.word = Word::kDiffers;
  c.verdicts.pairs = {v};
  c.backgrounds = {
      {{{{"mass", "body trunk", 0.5, 0.25, "kg"}}, audited_quantities()}, {"servo law"}, std::nullopt}};
  c.consensus = {{{0}, {1}}, {}, {}, {}, {}, "two votes"};
  return c;
}

// One factor, or several, between two engines of a family that are no ends of it.
TEST(FindFamily, BeginsAtAnEngineOfTheSameLawsThatAreSolvedOtherwise) {
  const auto law = [](const Engine& engine) { return engine.info.laws.contact_law(); };
  for (const EngineFamily& family : engine_families()) {
    const Engine to = find_engine(family.to);
    for (const std::string& name : available_engines()) {
      const Engine engine = find_engine(name);
      EngineFamily found;
      try {
        found = find_family(engine, to);
      } catch (const ConfigError&) {
        continue;
      }
      if (found.factors.front().name != "dynamics" || found.to != family.to) continue;
      EXPECT_EQ(law(engine), law(found.with({"dynamics"}))) << name;
      EXPECT_NO_THROW(found.validate());
      EXPECT_EQ(found.with({}).name(), name);
      EXPECT_NE(found.with({"dynamics"}).name(), name);
      std::vector<std::string> all;
      for (const ModelFactor& factor : found.factors) all.push_back(factor.name);
      EXPECT_EQ(found.with(all).name(), family.to);
      EXPECT_EQ(find_family(to, engine).from, name) << "either way round";
    }
  }
}

TEST(FindFamily, TakesThePartBetweenTwoEnginesOfOne) {
  const std::vector<std::string> all = available_engines();
  if (std::find(all.begin(), all.end(), "bullet") == all.end()) GTEST_SKIP() << "needs bullet";
  const Engine matched = find_engine("bullet:matched"), one = find_engine("bullet:matched+coulomb"),
               two = find_engine("bullet:matched+coulomb+hard_friction"),
               surface = find_engine("bullet:matched+surface");
  for (const EngineFamily& family : {find_family(matched, one), find_family(one, matched)}) {
    ASSERT_EQ(family.factors.size(), 1U);
    EXPECT_EQ(family.factors[0].name, "coulomb");
    EXPECT_EQ(family.from, matched.name());
    EXPECT_EQ(family.with({}).name(), matched.name());
    EXPECT_EQ(family.with({"coulomb"}).name(), one.name());
  }
  const EngineFamily part = find_family(one, two);
  ASSERT_EQ(part.factors.size(), 1U);
  EXPECT_EQ(part.with({"hard_friction"}).name(), two.name());
  EXPECT_NO_THROW(part.validate());
  EXPECT_EQ(find_family(matched, two).factors.size(), 2U);
  EXPECT_THROW((void)find_family(one, surface), ConfigError);
}

TEST(EngineComparisonReport, BeginsWithASentenceThatAColleagueCanRepeat) {
  const EngineComparison c = by_hand();
  const std::string sentence =
      "trot on flat, 5 s: one and two differ in slip (-0.113 m, margin 0.02); within the margin: way. No run "
      "of 12 "
      "failed, which "
      "excludes failures in more than 22 % of runs.";
  EXPECT_EQ(summary(c), sentence);
  EXPECT_EQ(describe(c).substr(0, sentence.size()), sentence);
  EXPECT_EQ(to_json(c)["summary"], sentence);
  EngineComparison own = c;  // margins and confidence of the user's are said with the words they made
  own.verdicts.options.confidence = 0.8;
  own.verdicts.pairs[0].statistics[0].statistic.margin.reason = kStatedByUser;
  EXPECT_NE(summary(own).find(" With a confidence of 0.8 and margins of the user's for way "),
            std::string::npos)
      << summary(own);
  EngineComparison failing = c;
  failing.verdicts.pairs[0].outcomes_b = {};
  failing.verdicts.pairs[0].outcomes_b[static_cast<std::size_t>(Outcome::kSlid)] = 12;
  EXPECT_NE(summary(failing).find("one: walked 12; two: slid 12."), std::string::npos) << summary(failing);
  EngineComparison agreeing = c;
  agreeing.verdicts.pairs[0].word = agreeing.verdicts.pairs[0].statistics[1].word = Word::kAgrees;
  EXPECT_NE(summary(agreeing).find("agree in all 2 statistics"), std::string::npos) << summary(agreeing);
  EngineComparison open = c;
  open.verdicts.pairs[0].word = open.verdicts.pairs[0].statistics[1].word = Word::kUnresolved;
  open.verdicts.pairs[0].starts_needed = 40;
  EXPECT_NE(summary(open).find("slip is not resolved (about 40 starts would tell)"), std::string::npos)
      << summary(open);
  EngineComparison step = c;
  step.verdicts.pairs[0].word = step.verdicts.pairs[0].statistics[1].word = Word::kStepDependent;
  EXPECT_NE(summary(step).find("depends on the time step, not on the engine"), std::string::npos)
      << summary(step);
}

TEST(EngineComparisonReport, HoldsEverythingThatBelongsToIt) {
  EngineComparison c = by_hand();
  c.starts_held = 6;
  const std::string text = describe(c);
  for (const char* part : {"Models: mass, body trunk: 0.5 against 0.25 kg.",
                           "Shared, and so no evidence: servo law.", "held 6 of these starts"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  nlohmann::ordered_json json = to_json(c);
  EXPECT_EQ(json["schema"]["name"], "verdict");
  EXPECT_EQ(json["word"], "differs");
  EXPECT_EQ(json["outcomes"]["two"]["walked"], 12);
  EXPECT_EQ(json["pairs"][0]["engines"][1], "two");
  EXPECT_EQ(json["pairs"][0]["shared"][0], "servo law");
  EXPECT_EQ(json["pairs"][0]["models"][0]["quantity"], "mass");
  EXPECT_EQ(json["pairs"][0]["models_compared"].size(), audited_quantities().size());
  EXPECT_EQ(json["pairs"][0]["attribution"], nullptr);
  c.backgrounds[0].attribution.emplace();
  c.backgrounds[0].attribution->from = "one";
  EXPECT_EQ(to_json(c)["pairs"][0]["attribution"]["from"], "one");
}

TEST(JudgeStages, AreToldWithTheirNames) {
  EXPECT_FALSE(progress_of({}, "judging"));
  std::vector<std::pair<std::string, double>> told;
  const Progress progress = progress_of(
      [&told](const std::string& stage, double share) { told.emplace_back(stage, share); }, "judging");
  progress(0.25);
  progress(1);
  EXPECT_EQ(told, (std::vector<std::pair<std::string, double>>{{"judging", 0.25}, {"judging", 1}}));
}

}  // namespace
}  // namespace crossgait
