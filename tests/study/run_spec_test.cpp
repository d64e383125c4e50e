#include "study/run_spec.h"

#include <cmath>
#include <functional>
#include <map>
#include <set>

#include <fmt/format.h>

#include "env/env_model.h"
#include "physics/core/error.h"
#include "physics/core/hash.h"
#include "study/run_maker.h"
#include "study/run_store.h"
#include "tests/study/runs.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

using Json = nlohmann::json;

TEST(RunSpec, HasOneTextThatStays) {
  // Results of years hang on this text. Where it changes on purpose, `schema` has to say so.
  Json json = Json::parse(canonical_json(walk_run()));
  EXPECT_EQ(json["behaviour"]["robot"]["description"].get<std::string>().size(), 64U);
  EXPECT_EQ(json["crossgait"], crossgait_version());
  json["crossgait"] = "";
  json["behaviour"]["robot"]["description"] =
      "";  // of angles that another machine's sine may round otherwise
  EXPECT_EQ(
      json.dump(),
      R"({"behaviour":{"bands":[],"command":null,"compensation":true,)"
      R"("contact":{"cfm":[0.0],"condim":[3.0],"cone":[0.0],"erp":[0.2],"friction":[0.6],"impratio":[1.0],)"
      R"("max_depenetration_velocity":[0.3],"rolling_friction":[0.0001],)"
      R"("solimp":[0.9,0.95,0.001,0.5,2.0],"solref":[0.02,1.0],"torsional_friction":[0.005]},)"
      R"("control_dt":0.002,)"
      R"("gait":"trot","heading_hold":true,)"
      R"("kind":"walk","parameters":{"body_height":0.062,"cycle_time":0.24,"duty_factor":0.6,"foot_clearance":0.0,)"
      R"("lateral_offset_fl":0.0,"lateral_offset_fr":0.0,"lateral_offset_rl":0.0,"lateral_offset_rr":0.0,)"
      R"("load_share":1.0,"stance_offset":0.0,"stance_width":0.0,"step_height":0.04,"step_length":0.04,"swing":"bezier","swing_shape":0.3},)"
      R"("physics_dt":0.001,)"
      R"("robot":{"description":"","name":"scara_quadruped"},"seconds":0.3,"settle_seconds":0.1,)"
      R"("terminations":["diverged","left_terrain"],"terrain":"rough:size_x=2,size_y=2","terrain_seed":0},"crossgait":"","engine":"mujoco","engine_version":"2.2.2",)"
      R"("horizon_s":null,"schema":{"name":"run","version":5},"seed":3,"start":1,)"
      R"("starts":{"heading_rad":0.2,"position_m":0.1,"push_mps":0.02,"tilt_rad":0.02},)"
      R"("variation":{"erp":1.0,"impratio":1.0,"iterations":1.0,"softness":1.0,"step":1.0}})");
  EXPECT_EQ(canonical_json(walk_run()), canonical_json(walk_run()));
  EXPECT_EQ(run_hash(walk_run()), fnv1a_hex(canonical_json(walk_run())));
  EXPECT_EQ(fnv1a_hex("foobar"), "85944171f73967e8");  // of the authors' test vectors
}

TEST(RunSpec, StatesEveryParameterOfAnEnvironment) {
  // Also those that it leaves to the gait and to the robot's size: where a default changes, the run is
  // another.
  RunSpec sparse = policy_run(), whole = policy_run();
  EnvConfig& environment = policy_of(whole).environment;
  environment = EnvModel::make(environment)->resolved();
  EXPECT_EQ(run_hash(sparse), run_hash(whole));
  const auto text = Json::parse(canonical_json(sparse))["behaviour"]["environment"].get<std::string>();
  for (const ParameterRow& row : gait_parameters())
    EXPECT_NE(text.find(fmt::format("  {}: {}\n", row.name, environment.parameters.find(row.name).value())),
              std::string::npos)
        << row.name;
  EXPECT_NE(text.find("residual_scale: 0.01\n"), std::string::npos);
}

using Change = std::function<void(RunSpec&)>;

/// Every change gives a hash of its own.
void expect_all_different(const RunSpec& run, const std::map<std::string, Change>& changes) {
  std::map<std::string, std::string> hashes{{run_hash(run), "as it is"}};
  for (const auto& [name, change] : changes) {
    RunSpec changed = run;
    change(changed);
    const auto [it, fresh] = hashes.emplace(run_hash(changed), name);
    EXPECT_TRUE(fresh) << name << " has the hash of " << it->second;
  }
}

std::map<std::string, Change> changes_of_any_run() {
  std::map<std::string, Change> all{
      {"engine", [](RunSpec& r) { r.engine = "bullet"; }},
      {"engine version", [](RunSpec& r) { r.engine_version = "2.2.3"; }},
      {"Crossgait's version", [](RunSpec& r) { r.crossgait = "0.0.1"; }},
      {"start", [](RunSpec& r) { r.start = 2; }},
      {"seed", [](RunSpec& r) { r.behaviour.seed = 4; }},
      {"step", [](RunSpec& r) { r.variation.step = 0.5; }},
      {"impratio", [](RunSpec& r) { r.variation.impratio = 0.5; }},
      {"softness", [](RunSpec& r) { r.variation.softness = 0.5; }},
      {"horizon", [](RunSpec& r) { r.horizon = 0.5; }},
      {"iterations", [](RunSpec& r) { r.variation.iterations = 0.5; }},
      {"position", [](RunSpec& r) { r.behaviour.starts.position_m = 0.3; }},
      {"heading", [](RunSpec& r) { r.behaviour.starts.heading_rad = 0.3; }},
      {"tilt", [](RunSpec& r) { r.behaviour.starts.tilt_rad = 0.3; }},
      {"push", [](RunSpec& r) { r.behaviour.starts.push_mps = 0.3; }},
  };
  return all;
}

TEST(RunSpec, ChangesWithEveryFieldOfAWalk) {
  std::map<std::string, Change> changes = changes_of_any_run();
  const auto add = [&changes](const char* name, const std::function<void(WalkConfig&)>& change) {
    changes[name] = [change](RunSpec& r) { change(walk_of(r)); };
  };
  add("robot", [](WalkConfig& c) { c.robot = "scara_quadruped_long"; });
  add("terrain", [](WalkConfig& c) { c.terrain = "flat"; });
  add("terrain settings", [](WalkConfig& c) { c.terrain = "rough:size_x=2,size_y=3"; });
  add("terrain seed", [](WalkConfig& c) { c.terrain_seed = 1; });
  add("friction", [](WalkConfig& c) { c.contact.add(friction_of(std::nextafter(0.6, 1))); });  // the last bit
  add("physics_dt", [](WalkConfig& c) { c.physics_dt = 2e-3; });
  add("gait", [](WalkConfig& c) { c.gait.gait = find_gait("pace"); });
  add("any gait", [](WalkConfig& c) { c.gait.gait.reset(); });
  add("command", [](WalkConfig& c) { c.gait.command = VelocityCommand{}; });
  add("vx", [](WalkConfig& c) { c.gait.command = VelocityCommand{0.1, 0, 0}; });
  add("vy", [](WalkConfig& c) { c.gait.command = VelocityCommand{0, 0.1, 0}; });
  add("yaw rate", [](WalkConfig& c) { c.gait.command = VelocityCommand{0, 0, 0.1}; });
  add("compensation", [](WalkConfig& c) { c.compensation = false; });
  add("heading_hold", [](WalkConfig& c) { c.heading_hold = false; });
  add("bands", [](WalkConfig& c) { c.gait.bands = default_speed_bands(); });
  add("a band's end", [](WalkConfig& c) {
    c.gait.bands = default_speed_bands();
    c.gait.bands[0].below += 0.01;
  });
  add("a band's parameter", [](WalkConfig& c) {
    c.gait.bands = default_speed_bands();
    c.gait.bands[1].gait.preferred.cycle_time += 0.01;
  });
  add("terminations", [](WalkConfig& c) { c.terminations.add(Outcome::kFell); });
  add("seconds", [](WalkConfig& c) { c.timing.seconds = 0.4; });
  add("control_dt", [](WalkConfig& c) { c.timing.control_dt = 4e-3; });
  add("settle", [](WalkConfig& c) { c.timing.settle_seconds = 0.2; });
  add("swing", [](WalkConfig& c) { c.gait.parameters.swing = SwingCurve::kMatched; });
  for (const ParameterRow& row : gait_parameters())
    add(row.name.data(), [&row](WalkConfig& c) { c.gait.parameters.*row.member += 1e-9; });
  expect_all_different(walk_run(), changes);
  RunSpec named = walk_run();
  named.variation.name = "by another name";
  named.variation.kind = Variation::Kind::kSetting;
  EXPECT_EQ(run_hash(named), run_hash(walk_run()));
}

TEST(RunSpec, ChangesWithEveryFieldOfAnEnvironment) {
  std::map<std::string, Change> changes = changes_of_any_run();
  const auto add = [&changes](std::string_view name, const std::function<void(EnvConfig&)>& change) {
    changes[std::string(name)] = [change](RunSpec& r) { change(policy_of(r).environment); };
  };
  changes["policy"] = [](RunSpec& r) { policy_of(r).policy = "random"; };
  changes["walk"] = [](RunSpec& r) { r = walk_run(); };
  add("robot", [](EnvConfig& c) { c.robot = "scara_quadruped_long"; });
  add("terrain", [](EnvConfig& c) { c.terrain = "rough"; });
  add("terrain seed", [](EnvConfig& c) { c.terrain_seed = 1; });
  add("friction", [](EnvConfig& c) { c.contact.add(friction_of(std::nextafter(0.6, 1))); });
  add("gait", [](EnvConfig& c) { c.gait = "walk"; });
  add("swing", [](EnvConfig& c) { c.parameters.swing = SwingCurve::kMatched; });
  for (const ParameterRow& row : gait_parameters())
    add(row.name, [&row](EnvConfig& c) { c.parameters[row.name] = row.default_value() + 1e-9; });
  add("adapt", [](EnvConfig& c) { c.adapt.pop_back(); });
  add("range", [](EnvConfig& c) { c.adaptation.ranges["cycle_time"] = {0.5, 1}; });
  add("delta scale", [](EnvConfig& c) { c.adaptation.delta_scales["cycle_time"] = 0.01; });
  add("residual_scale", [](EnvConfig& c) { c.residual_scale = 0.02; });
  add("vx", [](EnvConfig& c) { c.command = VelocityCommand{0.1, 0, 0}; });
  add("vy", [](EnvConfig& c) { c.command = VelocityCommand{0, 0.1, 0}; });
  add("yaw rate", [](EnvConfig& c) { c.command = VelocityCommand{0, 0, 0.1}; });
  add("observation", [](EnvConfig& c) { c.observation.emplace_back("terrain"); });
  for (std::size_t i = 0; i < RewardTerms::size(); ++i)
    add(std::string("reward ") + std::string(reward_terms()[i].name),
        [i](EnvConfig& c) { c.reward[i] += 1; });
  add("physics_dt", [](EnvConfig& c) { c.physics_dt = 2e-3; });
  add("control_dt", [](EnvConfig& c) { c.control_dt = 1e-3; });
  add("policy_dt", [](EnvConfig& c) { c.policy_dt = 4e-3; });
  add("episode_seconds", [](EnvConfig& c) { c.episode_seconds = 0.4; });
  add("settle", [](EnvConfig& c) { c.settle_seconds = 0.2; });
  add("tilt limit", [](EnvConfig& c) { c.tilt_limit_deg = 50; });
  for (const OutcomeRow& row : outcome_rows()) {
    if (!row.at_once || row.outcome == Outcome::kDiverged) continue;
    add(std::string("terminations ") + std::string(row.name),
        [&row](EnvConfig& c) { c.terminations.in[static_cast<std::size_t>(row.outcome)] = false; });
  }
  expect_all_different(policy_run(), changes);
  RunSpec elsewhere = policy_run();
  policy_of(elsewhere).environment.engine = "bullet";  // the run says in which
  EXPECT_EQ(run_hash(elsewhere), run_hash(policy_run()));
}

TEST(RunSpec, ChangesWithEveryRangeOfAnEnvironment) {
  RunSpec run = policy_run();
  for (Range& range : policy_of(run).environment.randomisation.ranges) range = {0.2, 0.4};
  policy_of(run).environment.settle_seconds = 0;  // which starts on the move need
  std::map<std::string, Change> changes;
  for (const RandomisationRow& row : randomisation_rows()) {
    const auto range = [&row](RunSpec& r) -> Range& {
      return policy_of(r).environment.randomisation[row.what];
    };
    changes[std::string("min of ") + std::string(row.name)] = [range](RunSpec& r) { range(r).min -= 0.01; };
    changes[std::string("max of ") + std::string(row.name)] = [range](RunSpec& r) { range(r).max += 0.01; };
  }
  expect_all_different(run, changes);
}

class Runs : public EngineTest {
 protected:
  static RunSpec in_this_engine(RunSpec run) {
    run.engine = GetParam();
    run.engine_version = find_engine(GetParam()).info.version;
    return run;
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(Runs);

TEST_P(Runs, RepeatWhatTheBehaviourDoes) {
  for (const RunSpec& spec : {in_this_engine(walk_run()), in_this_engine(policy_run())}) {
    const Behaviour behaviour = make_behaviour(spec.behaviour);
    for (const Variation& variation : variations()) {
      RunSpec varied = spec;
      varied.variation = variation;
      varied.start = 2;
      const RunResult result = run(varied);
      const BehaviourRun expected = behaviour.run(find_engine(GetParam()), variation, 2, kToTheEnd);
      EXPECT_EQ(result.run.values, expected.values) << variation.name;
      EXPECT_EQ(result.run.seconds, expected.seconds) << variation.name;
      EXPECT_EQ(result.run.outcome, expected.outcome) << variation.name;
      EXPECT_EQ(result.keys, keys_of(behaviour));
    }
  }
}

TEST_P(Runs, AreTheSameWhenManyOfOneBehaviourAreMade) {
  for (const RunSpec& spec : {in_this_engine(walk_run()), in_this_engine(policy_run())}) {
    const RunMaker maker(spec.behaviour);
    for (std::size_t k = 0; k < 2; ++k) {
      RunSpec varied = spec;
      varied.variation = variations()[k];
      varied.start = k;
      EXPECT_EQ(maker.describe(GetParam(), variations()[k], k), to_json(varied));
      EXPECT_EQ(maker.make(GetParam(), variations()[k], k), stored_run(to_json(varied), run(varied)));
    }
    for (const Variation& variation : variations())
      EXPECT_EQ(maker.allows(GetParam(), variation), variation.of(find_engine(GetParam()).info) &&
                                                         make_behaviour(spec.behaviour).allows(variation))
          << variation.name;
  }
}

TEST_P(Runs, StartAlikeAsWalksAndAsPolicies) {
  // The same place, heading, push and ground: then a walk and the zero policy are one motion, in all numbers.
  RunSpec walk = in_this_engine(walk_run());
  walk_of(walk).timing.seconds = 1.2;  // the push comes within the first second
  PolicyConfig policy;
  policy.environment = walk_of(walk).environment();
  policy.environment.terminations = OutcomeSet::of_walks();
  RunSpec episode = walk;
  episode.behaviour.what = policy;
  const Behaviour walks = make_behaviour(walk.behaviour), episodes = make_behaviour(episode.behaviour);
  const Engine engine = find_engine(GetParam());
  std::vector<std::optional<double>> last;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<std::optional<double>> a = walks.run(engine, {}, k, kToTheEnd).values;
    std::vector<std::optional<double>> b = episodes.run(engine, {}, k, kToTheEnd).values;
    ASSERT_EQ(b.size(), a.size() + 1);  // and the reward
    b.pop_back();
    EXPECT_EQ(a, b) << "start " << k;
    EXPECT_NE(a, last);
    last = a;
  }
  // The push is part of it.
  walk.behaviour.starts.push_mps = 0;
  EXPECT_NE(make_behaviour(walk.behaviour).run(engine, {}, 2, kToTheEnd).values, last);
}

TEST_P(Runs, OfNeighbouringSeedsStandOnGroundsOfTheirOwn) {
  // Nothing but the ground differs from start to start, and from seed to seed.
  std::set<std::vector<std::optional<double>>> seen;
  RunSpec walk = in_this_engine(walk_run());
  walk.behaviour.starts = {.position_m = 0, .heading_rad = 0, .tilt_rad = 0, .push_mps = 0};
  PolicyConfig policy;
  policy.environment = walk_of(walk).environment();
  for (const std::uint64_t seed : {0, 1, 2}) {
    walk_of(walk).terrain_seed = policy.environment.terrain_seed = seed;
    RunSpec episode = walk;
    episode.behaviour.what = policy;
    const Behaviour walks = make_behaviour(walk.behaviour), episodes = make_behaviour(episode.behaviour);
    for (std::size_t k = 0; k < 3; ++k) {
      const Engine engine = find_engine(GetParam());
      EXPECT_TRUE(seen.insert(walks.run(engine, {}, k, kToTheEnd).values).second) << seed << ", " << k;
      EXPECT_TRUE(seen.insert(episodes.run(engine, {}, k, kToTheEnd).values).second) << seed << ", " << k;
    }
  }
}

TEST_P(Runs, RefuseAnotherVersionOfTheEngine) {
  RunSpec old = in_this_engine(walk_run());
  old.engine_version = "0.1";
  try {
    (void)run(old);
    FAIL() << "an engine that is not there was run";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("0.1"), std::string::npos) << error.what();
  }
}

TEST_P(Runs, RefuseAnotherVersionOfCrossgait) {
  RunSpec old = in_this_engine(walk_run());
  old.crossgait = "0.0.1";
  EXPECT_THROW((void)run(old), ConfigError);
}

}  // namespace
}  // namespace crossgait
