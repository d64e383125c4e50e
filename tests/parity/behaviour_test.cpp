// What a verdict varies, where runs start and what they are judged by.
#include "parity/behaviour.h"

#include <set>

#include <gtest/gtest.h>

#include "backends/registry.h"
#include "env/env_model.h"
#include "motion/gait_source.h"
#include "physics/core/error.h"
#include "policy/policy.h"
#include "scenes/scenes.h"

namespace crossgait {
namespace {

using Kind = Variation::Kind;

TEST(Variations, AreFactorsOnTheWorld) {
  WorldSpec world;
  world.robot = scenes::quadruped();
  world.physics_dt = 1e-3;
  world.solver = {.tolerance = 1e-8, .iterations = 25};
  world.contact.impratio = 2;
  const auto varied = [&world](const Variation& v) {
    WorldSpec result = world;
    v.apply(result, world.physics_dt);
    return result;
  };
  const WorldSpec one = varied({.step = 0.5, .iterations = 0.5, .impratio = 10, .softness = 0.25, .erp = 2});
  EXPECT_DOUBLE_EQ(one.physics_dt, 5e-4);
  EXPECT_EQ(one.solver.iterations, 13);                          // 12.5, to the nearest
  EXPECT_EQ(varied({.iterations = 0.01}).solver.iterations, 1);  // and never none
  EXPECT_DOUBLE_EQ(one.contact.impratio, 20);
  EXPECT_DOUBLE_EQ(one.contact.softness.time_constant, 0.25 * world.contact.softness.time_constant);
  EXPECT_EQ(one.contact.erp, 2 * world.contact.erp);
  EXPECT_EQ(one.solver.tolerance, world.solver.tolerance);
  const WorldSpec same = varied(nominal_variation());
  EXPECT_EQ(same.physics_dt, world.physics_dt);
  EXPECT_EQ(same.solver.iterations, world.solver.iterations);
  EXPECT_EQ(same.contact.impratio, world.contact.impratio);
}

TEST(Variations, BeginAsAskedAndConcernTheEnginesThatDeclareThem) {
  EXPECT_EQ(&variations()[0], &nominal_variation());
  EXPECT_EQ(nominal_variation().kind, Kind::kNominal);
  EXPECT_EQ(half_step().step, 0.5);
  EXPECT_EQ(quarter_step().step, 0.25);
  EngineInfo rigid, soft;
  rigid.capabilities.sweeps = rigid.capabilities.error_reduction = true;
  soft.capabilities.soft_contact = soft.capabilities.soft_friction = true;
  for (const Variation& v : variations()) {
    EXPECT_EQ(&find_variation(v.name), &v);
    EXPECT_EQ(v.of(rigid), v.impratio == 1 && v.softness == 1) << v.name;
    EXPECT_EQ(v.of(soft), v.iterations == 1 && v.erp == 1) << v.name;
  }
  EXPECT_THROW((void)find_variation("no such"), ConfigError);
}

// What is stiffer than MuJoCo's law can have it in the steps asked for is as stiff as it is there, and no
// stiffer in shorter ones: half the step is half the step and nothing else.
TEST(Variations, KeepTheLawOfTheStepsThatWereAskedFor) {
  WorldSpec world;
  auto robot = std::make_shared<RobotDescription>(*scenes::quadruped());
  robot->loop_softness.time_constant = 1e-3;
  world.robot = robot;
  world.physics_dt = 1e-3;
  world.contact.softness.time_constant = 5e-4;
  WorldSpec half = world, none = world;
  half_step().apply(half, world.physics_dt);
  EXPECT_EQ(half.contact.softness.time_constant, 2e-3);
  EXPECT_EQ(half.robot->loop_softness.time_constant, 2e-3);
  EXPECT_EQ(half.physics_dt, 5e-4);
  none.contact.softness.time_constant = robot->loop_softness.time_constant = 3e-3;
  half_step().apply(none, world.physics_dt);
  EXPECT_EQ(none.contact.softness.time_constant, 3e-3);
  EXPECT_EQ(none.robot, world.robot);  // no copy
}

TEST(Variations, AreNotOfContactsThatCannotBeStiffer) {
  Behaviour behaviour;
  behaviour.physics_dt = behaviour.control_dt = 1e-3;
  behaviour.contact.softness.time_constant = 2e-3;
  EXPECT_EQ(behaviour.why_not({.softness = 0.5}), "contacts are as stiff as the step lets them be");
  EXPECT_EQ(behaviour.why_not({.impratio = 10}), "");
  behaviour.contact.softness.time_constant = 4e-3;
  EXPECT_EQ(behaviour.why_not({.softness = 0.5}), "");
  EXPECT_EQ(behaviour.why_not({.erp = 2}), "");
  behaviour.contact.erp = 0.6;
  EXPECT_EQ(behaviour.why_not({.erp = 2}), "a step undoes more than half of a penetration");
  EXPECT_EQ(behaviour.why_not({.iterations = 0.2}), "");
  behaviour.contact.erp = 0;
  EXPECT_EQ(behaviour.why_not({.erp = 2}), "no penetration is undone");
}

TEST(Variations, HaveToDivideTheControlStep) {
  Behaviour behaviour;
  behaviour.physics_dt = 1e-3;
  const auto allows = [&behaviour](double control_dt, double step) {
    behaviour.control_dt = control_dt;
    return behaviour.allows({.step = step});
  };
  EXPECT_TRUE(allows(2e-3, 1));
  EXPECT_TRUE(allows(2e-3, 2));
  EXPECT_TRUE(allows(1e-3, 0.5));
  EXPECT_FALSE(allows(1e-3, 2));
  EXPECT_FALSE(allows(3e-3, 2));
}

TEST(StartRanges, AreEachWayAndLeaveWhatIsOn) {
  using enum Randomised;
  const RobotDescription& robot = *scenes::quadruped();
  const StartRanges ranges{.position_m = 0.5, .heading_rad = 0.25, .tilt_rad = 0.125, .push_mps = 0.0625};
  Randomisation base;
  base[kStartY] = {2, 3};
  base[kFriction] = {0.5, 0.75};
  const Randomisation all = ranges.over(base, robot);
  EXPECT_EQ(all[kStartX], (Range{-0.5, 0.5}));
  EXPECT_EQ(all[kStartY], (Range{2, 3}));
  EXPECT_EQ(all[kStartYaw], (Range{-0.25, 0.25}));
  EXPECT_EQ(all[kStartRoll], (Range{-0.125, 0.125}));
  EXPECT_EQ(all[kStartPitch], (Range{-0.125, 0.125}));
  EXPECT_EQ(all[kFriction], (Range{0.5, 0.75}));
  // One push in the first second, of the impulse that gives the whole robot its speed.
  const double impulse = 0.0625 * robot.total_mass();
  EXPECT_EQ(all[kPushImpulse], (Range{impulse, impulse}));
  EXPECT_EQ(all[kPushInterval], (Range{0, 1}));
  EXPECT_EQ(all[kPushCount], (Range{1, 1}));

  base[kPushImpulse] = {5, 6};
  base[kPushInterval] = {7, 8};
  const Randomisation own = ranges.over(base, robot);
  EXPECT_EQ(own[kPushImpulse], (Range{5, 6}));
  EXPECT_EQ(own[kPushInterval], (Range{7, 8}));
  EXPECT_FALSE((StartRanges{.push_mps = 0}.over({}, robot).is_on(kPushImpulse)));
}

TEST(Behaviours, NoTwoSeedsShareAGroundOrItsStream) {
  std::set<std::uint64_t> seen;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    for (std::size_t k = 0; k < 100; ++k) {
      EXPECT_TRUE(seen.insert(terrain_seed_of_start(seed, k)).second) << seed << ", " << k;
      EXPECT_TRUE(seen.insert(derived_seed(seed, k)).second) << seed << ", " << k;  // of the start
    }
  }
}

TEST(Behaviours, AreNamedAndJudgedByTheSameStatistics) {
  WorldSpec world = scenes::world_of(scenes::quadruped());
  world.physics_dt = 5e-4;
  WalkSetup setup;
  setup.gait = "crawl";
  setup.timing.seconds = 2.5;
  setup.timing.control_dt = 4e-3;
  const Behaviour walk = walk_behaviour(world, setup, [](std::size_t) { return Terrain(); });
  EXPECT_EQ(walk.name, "crawl on flat, 2.5 s");
  EXPECT_EQ(walk.physics_dt, 5e-4);
  EXPECT_EQ(walk.control_dt, 4e-3);
  EXPECT_TRUE(walk.trace);

  EnvConfig config;
  config.terrain = "rough";
  config.episode_seconds = 3;
  config.physics_dt = 5e-4;
  config.control_dt = 4e-3;
  config.policy_dt = 4e-3;
  const PolicyFactory none = [](const PolicyInterface&) { return std::unique_ptr<Policy>(); };
  const Behaviour policy = policy_behaviour(config, none, "some.yaml");
  EXPECT_EQ(policy.name, "policy some.yaml on rough, 3 s");
  EXPECT_EQ(policy.physics_dt, 5e-4);
  EXPECT_EQ(policy.control_dt, 4e-3);
  EXPECT_TRUE(policy.trace);
  EXPECT_EQ(policy.seconds, 3);
  EXPECT_EQ(policy.cut_dt, 4e-3);
  EXPECT_EQ(walk.seconds, 2.5);

  std::vector<std::string> names;
  for (const Statistic& s : policy.statistics) names.push_back(s.name + ", " + s.unit);
  EXPECT_EQ(names,
            (std::vector<std::string>{"distance, m", "RMS roll, deg", "RMS pitch, deg",
                                      "slip of loaded feet, m", "cost of transport, -", "duty factor, -",
                                      "heading error, deg", "swing contact, -", "total reward, -"}));
  ASSERT_EQ(walk.statistics.size() + 1, policy.statistics.size());
  for (std::size_t i = 0; i < walk.statistics.size(); ++i) {
    EXPECT_EQ(walk.statistics[i].key, policy.statistics[i].key);
    EXPECT_GT(walk.statistics[i].margin.absolute, 0);
    EXPECT_FALSE(walk.statistics[i].margin.reason.empty());
  }
}

// A run that is cut is the beginning of the whole one.
TEST(Behaviours, CanBeCut) {
  WorldSpec world = scenes::world_of(scenes::quadruped());
  WalkSetup setup;
  setup.gait = "trot";
  setup.timing = {.seconds = 0.4, .settle_seconds = 0.1};
  setup.make_controller = [](const WorldSpec& w) { return make_gait_controller(choose_gait("trot", {}), w); };
  EnvConfig config;
  config.episode_seconds = 0.4;
  config.settle_seconds = 0.1;
  if (available_engines().empty()) GTEST_SKIP() << "no engine is built in";
  const Engine engine = find_engine(available_engines().front());
  const auto flat = [](std::size_t) { return Terrain(); };
  setup.timing.seconds = 0.2;
  const BehaviourRun shorter =
      walk_behaviour(world, setup, flat).run(engine, nominal_variation(), 0, kToTheEnd);
  setup.timing.seconds = 0.4;
  const BehaviourRun cut = walk_behaviour(world, setup, flat).run(engine, nominal_variation(), 0, 0.2);
  EXPECT_EQ(cut.values, shorter.values);
  EXPECT_NEAR(cut.seconds, 0.2, 1e-9);
  const Behaviour policy = policy_behaviour(
      config, [](const PolicyInterface& interface) { return make_policy("zero", interface); }, "zero");
  EXPECT_NEAR(policy.run(engine, nominal_variation(), 0, 0.2).seconds, 0.2, 1e-9);
  EXPECT_NEAR(policy.run(engine, nominal_variation(), 0, kToTheEnd).seconds, 0.4, 1e-9);
  EXPECT_GT(policy.trace(engine, 0).size(), 1U);
}

/// Asks for three times what there is in the first entry of the action, in a share of steps.
class Greedy : public Policy {
 public:
  Greedy(const PolicyInterface& interface, int every) : Policy("greedy", interface), every_(every) {}

 private:
  void do_reset(std::uint64_t /*seed*/) noexcept override { steps_ = 0; }
  void do_act(std::span<const double> /*observation*/, std::span<double> action) noexcept override {
    std::fill(action.begin(), action.end(), 0.0);
    if (steps_++ % every_ == 0) std::fill(action.begin(), action.end(), 3.0);
  }
  int every_, steps_ = 0;
};

TEST(Behaviours, NoteActionsThatAreClipped) {
  if (available_engines().empty()) GTEST_SKIP() << "no engine is built in";
  const Engine engine = find_engine(available_engines().front());
  EnvConfig config;
  config.episode_seconds = 1;
  const auto notes_of = [&](int every) {
    return policy_behaviour(
               config,
               [every](const PolicyInterface& interface) {
                 return std::make_unique<Greedy>(interface, every);
               },
               "greedy")
        .notes(engine);
  };
  const std::vector<std::string> notes = notes_of(1);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(notes[0].starts_with("greedy: 100 % of its actions are beyond")) << notes[0];
  EXPECT_EQ(notes_of(1000), std::vector<std::string>());
}

// Lying on its back from the start, it is not watched kicking for the rest of the time.
TEST(Behaviours, EndWithAFailure) {
  if (available_engines().empty()) GTEST_SKIP() << "no engine is built in";
  WorldSpec world = scenes::world_of(scenes::quadruped());
  WalkSetup setup;
  setup.gait = "trot";
  setup.timing = {.seconds = 2, .settle_seconds = 0.1};
  setup.make_controller = [](const WorldSpec& w) { return make_gait_controller(choose_gait("trot", {}), w); };
  const StartRanges hard_pushes{.push_mps = 3};
  const Behaviour walk = walk_behaviour(
      world, setup, [](std::size_t) { return Terrain(); }, hard_pushes);
  const BehaviourRun run =
      walk.run(find_engine(available_engines().front()), nominal_variation(), 0, kToTheEnd);
  EXPECT_TRUE(is_failure(run.outcome)) << name(run.outcome);
  EXPECT_LT(run.seconds, 2);
}

}  // namespace
}  // namespace crossgait
