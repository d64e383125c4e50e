// Worlds that share what is alike are the same as worlds apart, whoever steps them, and in whatever order.
#include "physics/engine/world_group.h"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "physics/core/worker_pool.h"
#include "scenes/scenes.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

using scenes::identical;

class WorldGroups : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(WorldGroups);

/// Lets a world diverge, and goes on where it was.
void run_away(PhysicsBackend& world) {
  const Snapshot saved = world.save();
  RobotState wild = world.home_state();
  wild.p_WB.z() = 1;
  wild.w_WB = {9e3, -9e3, 9e3};
  wild.qd.setConstant(9e3);
  world.reset(wild);
  const JointTargets home = scenes::home_targets(world.robot());
  for (int i = 0; i < 1000 && world.step(home) == StepStatus::kOk;) ++i;
  EXPECT_EQ(world.step(home), StepStatus::kDiverged);
  world.restore(saved);
}

/// Takes one world some steps further: each has a phase of its own, one diverges on the way, all are asked.
void go(PhysicsBackend& world, std::size_t number, int round, const scenes::Trot& trot) {
  if (number == 1 && round == 5) run_away(world);
  if (round % 3 == static_cast<int>(number) % 3) {
    world.body_pose(2);
    world.mass_matrix();
    world.terrain_height(0.1, 0.05);
  }
  for (int i = 0; i < 10; ++i) {
    const double time = 0.1 * static_cast<double>(number) + 1e-3 * (10 * round + i);
    ASSERT_EQ(world.step(trot.targets(time)), StepStatus::kOk);
  }
}

TEST_P(WorldGroups, ChangeNoResult) {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  spec.terrain = make_terrain("rough:seed=3,size_x=2,size_y=2");
  std::vector<WorldSpec> specs(7, spec);
  specs[4].contact.friction = 0.3;  // not alike
  specs[5].fixed_base = true;
  specs[6].terrain = make_terrain("rough:seed=4,size_x=2,size_y=2");
  const auto group = std::make_shared<WorldGroup>(2);
  std::vector<std::unique_ptr<PhysicsBackend>> together, apart;
  for (const WorldSpec& one : specs) {
    apart.push_back(make(one));
    WorldSpec of_group = one;
    of_group.group = group;
    together.push_back(make(of_group));
    EXPECT_EQ(together.back()->spec().group,
              nullptr);  // or a copy's world would share what is another thread's
  }

  const scenes::Trot trot(*scenes::quadruped());
  WorkerPool pool(2);
  for (int round = 0; round < 30; ++round) {
    pool.run(together.size(), [&](std::size_t i) { go(*together[i], i, round, trot); });
    for (std::size_t i = 0; i < apart.size(); ++i) go(*apart[i], i, round, trot);
  }
  for (std::size_t i = 0; i < apart.size(); ++i)
    EXPECT_TRUE(identical(together[i]->state(), apart[i]->state())) << "world " << i;
  EXPECT_FALSE(identical(together[0]->state(), together[4]->state()));
}

TEST_P(WorldGroups, AreOutlivedByTheirWorlds) {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  spec.group = std::make_shared<WorldGroup>(3);
  auto first = make(spec);
  const auto second = make(spec);
  spec.group = nullptr;
  first = nullptr;
  EXPECT_EQ(second->step(scenes::home_targets(*spec.robot), 10), StepStatus::kOk);
}

TEST(WorkerPool, NumbersItsWorkers) {
  WorkerPool pool(3);
  pool.run(100, [](std::size_t) {
    const std::size_t mine = WorkerPool::worker();
    EXPECT_LT(mine, 3U);
    WorkerPool inner(1);
    inner.run(1, [](std::size_t) { EXPECT_EQ(WorkerPool::worker(), 0U); });
    EXPECT_EQ(WorkerPool::worker(), mine);
  });
  EXPECT_EQ(WorkerPool::worker(), 0U);
}

}  // namespace
}  // namespace crossgait
