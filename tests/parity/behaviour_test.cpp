// What a verdict varies, where runs start and what they are judged by.
#include "parity/behaviour.h"

#include <set>

#include <gtest/gtest.h>

#include "env/env_model.h"
#include "scenes/scenes.h"

namespace crossgait {
namespace {

using Kind = Variation::Kind;

TEST(Variations, AreFactorsOnStepToleranceAndIterations) {
  WorldSpec world;
  world.physics_dt = 1e-3;
  world.solver = {.tolerance = 1e-8, .iterations = 25};
  const auto varied = [&world](const Variation& v) {
    WorldSpec result = world;
    v.apply(result);
    return result;
  };
  const WorldSpec one = varied({"", Kind::kSolver, 0.5, 100, 0.5});
  EXPECT_DOUBLE_EQ(one.physics_dt, 5e-4);
  EXPECT_DOUBLE_EQ(one.solver.tolerance, 1e-6);
  EXPECT_EQ(one.solver.iterations, 13);                                     // 12.5, to the nearest
  EXPECT_EQ(varied({"", Kind::kSolver, 1, 1, 0.01}).solver.iterations, 1);  // and never none
  const WorldSpec same = varied(variations().front());
  EXPECT_EQ(same.physics_dt, world.physics_dt);
  EXPECT_EQ(same.solver.tolerance, world.solver.tolerance);
  EXPECT_EQ(same.solver.iterations, world.solver.iterations);
}

TEST(Variations, AreTheSettingsThatTheHeaderNames) {
  struct Expected {
    Kind kind;
    double step, tolerance, iterations;
  };
  const Expected expected[] = {{Kind::kNominal, 1, 1, 1},
                               {Kind::kTimeStep, 0.5, 1, 1},
                               {Kind::kTimeStep, 2, 1, 1},
                               {Kind::kSolver, 1, 100, 0.5},
                               {Kind::kSolver, 1, 0.01, 2}};
  ASSERT_EQ(variations().size(), std::size(expected));
  for (std::size_t i = 0; i < variations().size(); ++i) {
    const Variation& v = variations()[i];
    EXPECT_EQ(v.kind, expected[i].kind) << v.name;
    EXPECT_EQ(v.step, expected[i].step) << v.name;
    EXPECT_EQ(v.tolerance, expected[i].tolerance) << v.name;
    EXPECT_EQ(v.iterations, expected[i].iterations) << v.name;
  }
}

TEST(Variations, HaveToDivideTheControlStep) {
  Behaviour behaviour;
  behaviour.physics_dt = 1e-3;
  const auto allows = [&behaviour](double control_dt, double step) {
    behaviour.control_dt = control_dt;
    return behaviour.allows({"", Kind::kTimeStep, step, 1, 1});
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
  EXPECT_FALSE(policy.trace);

  std::vector<std::string> names;
  for (const Statistic& s : policy.statistics) names.push_back(s.name + ", " + s.unit);
  EXPECT_EQ(names,
            (std::vector<std::string>{"distance, m", "mean speed, m/s", "RMS roll, deg", "RMS pitch, deg",
                                      "slip of loaded feet, m", "cost of transport, -", "duty factor, -",
                                      "heading error, deg", "swing contact, -", "slip per path, -",
                                      "failures, fraction", "total reward, -"}));
  ASSERT_EQ(walk.statistics.size() + 1, policy.statistics.size());
  for (std::size_t i = 0; i < walk.statistics.size(); ++i) {
    EXPECT_EQ(walk.statistics[i].name, policy.statistics[i].name);
    EXPECT_EQ(walk.statistics[i].counts_failures, walk.statistics[i].name == "failures");
    EXPECT_GT(walk.statistics[i].absolute_floor, 0);
  }
}

}  // namespace
}  // namespace crossgait
