// What would end the process inside DART ends the walk instead: its library asserts that squares of
// velocities and forces are numbers.
#include <gtest/gtest.h>

#include "backends/dart/dart_backend.h"
#include "scenes/scenes.h"

namespace crossgait::dart {
namespace {

TEST(DartDivergence, OfAPushIsAnOutcomeAndTheWorldWorksAfterAReset) {
  for (const char* name : {"dart", "dart:matched", "dart+stock"}) {
    SCOPED_TRACE(name);
    const Engine engine = *find(name);
    const WorldSpec spec = scenes::world_of(scenes::quadruped());
    const auto fresh = engine.make(spec), world = engine.make(spec);
    const JointTargets home = scenes::home_targets(world->robot());
    ASSERT_EQ(world->step(home, 5), StepStatus::kOk);
    // N s in a millisecond: a force whose square is still a number, so that nothing but the guard stops it.
    world->apply_push(Vector3(1e17, 0, 0));
    EXPECT_EQ(world->step(home), StepStatus::kDiverged);
    world->reset();
    ASSERT_EQ(world->step(home, 50), StepStatus::kOk);
    ASSERT_EQ(fresh->step(home, 50), StepStatus::kOk);
    EXPECT_TRUE(scenes::identical(world->state(), fresh->state()));
  }
}

// The strongest servos that a robot may have tear this one apart within steps.
TEST(DartDivergence, OfServosIsAnOutcomeToo) {
  const WorldSpec gentle = scenes::world_of(scenes::quadruped());
  WorldSpec strong = gentle;
  auto robot = std::make_shared<RobotDescription>(*strong.robot);
  for (Body& body : robot->bodies) {
    if (body.joint.kp > 0) body.joint.kp = body.joint.effort_limit = 1e9;
  }
  strong.robot = std::move(robot);
  for (const char* name : {"dart", "dart:matched", "dart+stock"}) {
    const auto world = find(name)->make(strong);
    JointTargets targets = scenes::home_targets(world->robot());
    targets.q.array() += 1e7;
    EXPECT_EQ(world->step(targets, 1000), StepStatus::kDiverged) << name;
    world->reset();
    EXPECT_TRUE(scenes::identical(world->state(), find(name)->make(gentle)->state())) << name;
  }
}

}  // namespace
}  // namespace crossgait::dart
