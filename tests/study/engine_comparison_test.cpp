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

PairVerdict judge_pair(const LoadedBehaviour& behaviour, const std::string& a, const std::string& b,
                       const JudgeOptions& options) {
  return judge_engines(behaviour, {a, b}, options).pairs.front();
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
  long lines() const {
    const std::string text = read(path("runs.jsonl"));
    return std::count(text.begin(), text.end(), '\n');
  }
};

TEST_F(EngineComparisons, AreAnAuditAndAVerdict) {
  for (const BehaviourSpec& spec : {short_trot(), short_policy()}) {
    const PairVerdict whole = judge_pair(spec, a(), b(), options());
    const Engine engine_a = find_engine(a()), engine_b = find_engine(b());
    const Verdict verdict = reach_verdict(make_behaviour(spec), engine_a, engine_b, options().verdict);
    EXPECT_EQ(to_json(whole.verdict).dump(), to_json(verdict).dump());
    const auto world_a = engine_a.make(LoadedBehaviour(spec).world()),
               world_b = engine_b.make(LoadedBehaviour(spec).world());
    EXPECT_EQ(to_json(whole.models).dump(), to_json(audit_models(*world_a, *world_b)).dump());
    EXPECT_FALSE(whole.attribution.has_value());
  }
}

TEST_F(EngineComparisons, ExplainWithTheFamilyOfTheTwoEngines) {
  if (engine_families().empty()) GTEST_SKIP() << "no engine is made of factors";
  JudgeOptions how = options(true);
  how.explain = true;
  BehaviourSpec spec = short_trot();
  const EngineFamily family = family_for(engine_families().front(), *LoadedBehaviour(spec).world().robot);
  std::get<WalkConfig>(spec.what).timing = {.seconds = 0.1, .settle_seconds = 0.05};
  const PairVerdict whole = judge_pair(spec, family.from, family.to, how);
  ASSERT_TRUE(whole.attribution.has_value());
  const Attribution attribution = attribute(make_behaviour(spec), family, {.starts = 4, .workers = 1});
  EXPECT_EQ(to_json(*whole.attribution).dump(), to_json(attribution).dump());
  // Every set of factors is an engine of its own to the store: the same again takes no run.
  const std::string bytes = read(path("runs.jsonl"));
  EXPECT_EQ(to_json(judge_pair(spec, family.from, family.to, how)).dump(), to_json(whole).dump());
  EXPECT_EQ(read(path("runs.jsonl")), bytes);
  how.explain = true;
  EXPECT_THROW(judge_pair(spec, family.to, family.to, how), ConfigError);
}

TEST_F(EngineComparisons, FromStoredRunsCostNoRun) {
  for (const BehaviourSpec& spec : {short_trot(), short_policy()}) {
    std::filesystem::remove(path("runs.jsonl"));
    const std::string plain = to_json(judge_pair(spec, a(), b(), options())).dump();
    const std::string first = to_json(judge_pair(spec, a(), b(), options(true, 2))).dump();
    // Both engines, every variation, four starts.
    EXPECT_EQ(lines(), static_cast<long>(2 * variations().size() * 4));
    const std::string bytes = read(path("runs.jsonl"));
    const std::string second = to_json(judge_pair(spec, a(), b(), options(true, 2))).dump();
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
  judge_pair(short_trot(), a(), b(), how);
  const std::string bytes = read(path("runs.jsonl"));
  how.verdict.starts = 5;
  judge_pair(short_trot(), a(), b(), how);
  EXPECT_EQ(lines(), static_cast<long>(2 * variations().size() * 5));
  EXPECT_EQ(read(path("runs.jsonl")).substr(0, bytes.size()), bytes);
}

TEST_F(EngineComparisons, LookAtTheWorldOfThePolicysConfiguration) {
  PolicyConfig config;
  config.environment.robot = "scara_quadruped_long";
  config.environment.terrain = "rough:size_x=2,size_y=2";
  config.environment.terrain_seed = 9;
  config.environment.friction = 0.3;
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
  if (find_engine(a()).info.laws.contact == find_engine(b()).info.laws.contact)
    GTEST_SKIP() << "engines of one contact law alone";
  // Where engines are known to hold the same differently: a steep slope, on which neither gets to friction's
  // limit. The worlds of a walk's defaults have no finding.
  PolicyConfig config;
  config.environment.robot = "scara_quadruped_long";
  config.environment.terrain = "slope:angle=40";
  config.environment.friction = 0.3;
  config.environment.episode_seconds = 0.02;
  config.environment.settle_seconds = 0;
  const PairVerdict pair = judge_pair({config, {}, 0}, a(), b(), options());
  WorldSpec world;
  world.robot = std::make_shared<const RobotDescription>(load_robot(find_robot("scara_quadruped_long")));
  world.terrain = make_terrain("slope:angle=40");
  world.contact.friction = 0.3;
  const auto world_a = make_world(a(), world), world_b = make_world(b(), world);
  const std::vector<AuditFinding> expected = audit_models(*world_a, *world_b);
  ASSERT_FALSE(expected.empty()) << "take another world to tell by";
  EXPECT_EQ(to_json(pair.models).dump(), to_json(expected).dump());
  EXPECT_TRUE(judge_pair(short_trot(), a(), b(), options()).models.empty());
}

TEST_F(EngineComparisons, StartWithNoRunWhereSomethingIsWrong) {
  JudgeOptions how = options(true);
  how.verdict.starts = 3;
  EXPECT_THROW(judge_pair(short_trot(), a(), b(), how), ConfigError);
  how = options(true);
  EXPECT_THROW(judge_pair(short_trot(), a(), "nonsense", how), ConfigError);
  BehaviourSpec spec = short_policy();
  std::get<PolicyConfig>(spec.what).policy = "nonsense";
  EXPECT_THROW(judge_pair(spec, a(), b(), how), ConfigError);
  spec = short_trot();
  std::get<WalkConfig>(spec.what).terrain = "moon";
  EXPECT_THROW(judge_pair(spec, a(), b(), how), ConfigError);
  EXPECT_FALSE(std::filesystem::exists(path("runs.jsonl")));
}

TEST(EngineComparisonReport, IsAVerdictTheModelsAndWhyIfAsked) {
  PairVerdict j;
  j.verdict.a = "one";
  j.verdict.b = "two";
  j.models = {{"mass", "body trunk", 0.5, 0.25, "kg"}};
  const std::string verdict = describe(j.verdict) + "\nModels: mass, body trunk: 0.5 against 0.25 kg.\n";
  EXPECT_EQ(describe(j), verdict);
  nlohmann::ordered_json json = to_json(j);
  EXPECT_EQ(json["schema"]["name"], "verdict");
  EXPECT_EQ(json["b"], "two");
  EXPECT_EQ(json["models"][0]["quantity"], "mass");
  EXPECT_FALSE(json.contains("attribution"));
  j.attribution.emplace();
  j.attribution->from = "one";
  EXPECT_EQ(describe(j), verdict + "\n" + describe(*j.attribution));
  EXPECT_EQ(to_json(j)["attribution"]["from"], "one");
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
