// Stretches of simulation that must not allocate once every buffer has had its largest size: for engines of
// the registry, and for tests of an engine's inside.
#pragma once

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "env/vector_env.h"
#include "motion/closed_loop.h"
#include "motion/gait_source.h"
#include "scenes/scenes.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/environments.h"

namespace crossgait {

inline std::size_t allocations_of_a_trot(const Engine& engine, const Terrain& terrain,
                                         const scenes::RobotPtr& robot = scenes::quadruped()) {
  WorldSpec spec = scenes::world_of(robot);
  spec.terrain = terrain;
  const auto world = engine.make(spec);
  const scenes::Trot trot(world->robot());
  int i = 0;
  const auto steps = [&](int count) {
    for (const int end = i + count; i < end; ++i) {
      EXPECT_EQ(world->step(trot.targets(i * 1e-3)), StepStatus::kOk);
      (void)world->foot_contacts();
    }
  };
  steps(1500);  // a stand and more than a cycle
  const AllocationScope scope;
  steps(1600);
  return scope.count();
}

/// Throws a robot with shapes of every kind on to the ground.
inline std::size_t allocations_of_a_fall(const Engine& engine, const Terrain& terrain) {
  WorldSpec spec = scenes::world_of(scenes::assortment());
  spec.terrain = terrain;
  const auto world = engine.make(spec);
  RobotState start = world->home_state();
  start.w_WB = {2, -3, 1};
  world->reset(start);
  const JointTargets targets = scenes::home_targets(world->robot());
  EXPECT_EQ(world->step(targets, 400), StepStatus::kOk);
  EXPECT_GT(world->contacts().count, 2);
  const AllocationScope scope;
  EXPECT_EQ(world->step(targets, 600), StepStatus::kOk);
  return scope.count();
}

/// Lands a robot with joint friction on 60 points.
/// @param before  steps that do not count; it is in the air for the first ten
inline std::size_t allocations_of_a_crowd_of_contacts(const Engine& engine, int before = 10) {
  const auto world =
      engine.make(scenes::world_of(scenes::with_joint_friction(scenes::heavy_sledge(60), 0.5)));
  RobotState start = world->home_state();
  start.p_WB.z() += 0.02;
  world->reset(start);
  const JointTargets targets = scenes::home_targets(world->robot());
  EXPECT_EQ(world->step(targets, 10), StepStatus::kOk);
  EXPECT_EQ(world->contacts().count, 0);
  if (before > 10) {
    EXPECT_EQ(world->step(targets, before - 10), StepStatus::kOk);
  }
  const AllocationScope scope;
  EXPECT_EQ(world->step(targets, 300), StepStatus::kOk);
  EXPECT_GT(world->contacts().count, 30);  // where contact is hard, not all that touch carry
  return scope.count();
}

inline std::size_t allocations_of_pushes_and_refused_targets(const Engine& engine) {
  const auto world = engine.make(scenes::world_of(scenes::quadruped()));
  const JointTargets targets = scenes::home_targets(world->robot());
  EXPECT_EQ(world->step(targets, 500), StepStatus::kOk);
  const AllocationScope scope;
  world->apply_push({0.01, 0, 0});
  EXPECT_EQ(world->step(targets, 10), StepStatus::kOk);
  EXPECT_EQ(world->step({}), StepStatus::kInvalidTargets);
  return scope.count();
}

/// Counts in the closed loop with pushes, on rough ground.
inline std::size_t allocations_of_a_loop(const Engine& engine, const WorldSpec& spec,
                                         const ControllerPtr& controller) {
  const auto world = engine.make(spec);
  ClosedLoop loop(*spec.robot, {});
  Randomisation randomisation;
  randomisation[Randomised::kPushImpulse] = {0.001, 0.005};
  randomisation[Randomised::kPushInterval] = {0.1, 0.2};
  Random random(1);
  loop.start(*world, *controller, {{}, 0, pushes_of(randomisation, draw(randomisation, random), random)});
  loop.advance(*world, *controller, 750);  // every buffer has had its largest size
  const AllocationScope scope;
  EXPECT_TRUE(loop.advance(*world, *controller, 750));
  EXPECT_GT(loop.statistics().summary(*world).physics_steps, 0);
  return scope.count();
}

inline WorldSpec rough_world() {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  spec.terrain = make_terrain("rough", 2);
  return spec;
}

inline std::size_t allocations_of_a_gait(const Engine& engine) {
  const WorldSpec spec = rough_world();
  return allocations_of_a_loop(engine, spec, make_gait_controller(choose_gait("trot", {}), spec));
}

inline std::size_t allocations_of_the_gait_by_speed(const Engine& engine) {
  const WorldSpec spec = rough_world();
  const GaitChoice choice = choose_gait("auto", {}, VelocityCommand{0.1, 0, 0.1});
  return allocations_of_a_loop(engine, spec, make_gait_controller(choice, spec));
}

inline std::size_t allocations_of_standing_feet(const Engine& engine) {
  const WorldSpec spec = rough_world();
  LegArray<Vector3> feet;
  feet.fill(Vector3(0, 0, -0.06));
  return allocations_of_a_loop(engine, spec, make_feet_controller([feet](double) { return feet; }, spec));
}

/// Makes everything that an environment can observe and reward, on rough ground.
inline EnvConfig full_environment() {
  EnvConfig config;
  config.terrain = "rough";
  config.observation.clear();
  for (const ObservationBlock& block : observation_blocks()) scenes::observe(config, block.name);
  config.reward.fill(1);
  return config;
}

/// Commands joints, seen late, noisy and with what came before.
inline EnvConfig full_joint_environment() {
  EnvConfig config = joint_environment();
  config.terrain = "rough";
  config.joints.delay = 0.006;
  for (ObservationTerm& term : config.observation) {
    term.scale = {0.5};
    term.noise = 0.01;
    term.clip = 10;
    term.delay = 0.004;
    term.history = 3;
  }
  config.reward.fill(1);
  return config;
}

inline std::size_t allocations_of_an_environment(const Engine& engine,
                                                 const EnvConfig& config = full_environment()) {
  QuadrupedEnv env(config, engine);
  std::vector<double> seen(env.observation_size());
  env.reset(1, seen);
  Random random(2);
  std::vector<double> action(env.action_size());
  const auto steps = [&](int count) {
    for (int i = 0; i < count; ++i) {
      for (double& a : action) a = random.uniform(-0.5, 0.5);
      env.step(action, seen);
    }
  };
  steps(1000);
  const AllocationScope scope;
  steps(1000);
  return scope.count();
}

/// Counts the allocations of all workers.
inline std::size_t allocations_of_a_batch(const Engine& engine) {
  VectorEnv env(full_environment(), engine, {.environments = 3, .workers = 2});
  std::vector<double> seen(3 * env.observation_size()), rewards(3), actions(3 * env.action_size(), 0.1);
  std::vector<std::uint8_t> terminated(3), truncated(3);
  env.reset(1, seen);
  const auto steps = [&](int count) {
    for (int i = 0; i < count; ++i) env.step(actions, {seen, rewards, terminated, truncated});
  };
  steps(1000);
  const ProcessAllocationScope scope;
  steps(500);
  return scope.count();
}

}  // namespace crossgait
