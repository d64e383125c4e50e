// The same input gives the same bits, beyond what conformance/determinism.cpp checks.
#include <bit>
#include <cstdint>
#include <cstring>
#include <thread>

#include <gtest/gtest.h>

#include "physics/core/error.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

class Determinism : public EngineTest {
 protected:
  static WorldSpec world(const std::string& terrain) {
    WorldSpec spec = scenes::world_of(scenes::quadruped());
    spec.terrain = make_terrain(terrain, 9);
    return spec;
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(Determinism);

bool same_bits(const RobotState& a, const RobotState& b) {
  const auto equal = [](const auto& x, const auto& y) {
    return x.size() == y.size() &&
           std::memcmp(x.data(), y.data(), sizeof(double) * static_cast<std::size_t>(x.size())) == 0;
  };
  return std::bit_cast<std::uint64_t>(a.time) == std::bit_cast<std::uint64_t>(b.time) &&
         equal(a.p_WB, b.p_WB) && equal(a.q_WB.coeffs(), b.q_WB.coeffs()) && equal(a.v_WB, b.v_WB) &&
         equal(a.w_WB, b.w_WB) && equal(a.q, b.q) && equal(a.qd, b.qd);
}

// Trots from step `from` to step `to`, pushed now and then; the state after every step.
std::vector<RobotState> trot(PhysicsBackend& instance, int from, int to) {
  const scenes::Trot motion(instance.robot());
  std::vector<RobotState> states;
  for (int i = from; i < to; ++i) {
    if (i % 400 == 399) instance.apply_push({0.01, 0.02, 0});
    EXPECT_EQ(instance.step(motion.targets(i * instance.spec().physics_dt)), StepStatus::kOk);
    states.push_back(instance.state());
  }
  return states;
}

void expect_same(const std::vector<RobotState>& a, const std::vector<RobotState>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_TRUE(same_bits(a[i], b[i])) << "first at step " << i;
}

TEST_P(Determinism, ShapesOfEveryKindRunAgainAndOn) {
  WorldSpec spec = scenes::world_of(scenes::assortment());
  spec.terrain = make_terrain("rough:flat_radius=0,size_x=4,size_y=4", 9);
  const auto used = make(spec), fresh = make(spec);
  const JointTargets home = scenes::home_targets(*spec.robot);
  const auto run = [&](PhysicsBackend& instance, int steps) {
    std::vector<RobotState> states;
    for (int i = 0; i < steps; ++i) {
      EXPECT_EQ(instance.step(home), StepStatus::kOk);
      states.push_back(instance.state());
    }
    return states;
  };
  RobotState start = used->home_state();
  start.w_WB = {2, -3, 1};
  used->reset(start);
  fresh->reset(start);
  expect_same(run(*used, 600), run(*fresh, 600));
  const Snapshot snapshot = used->save();
  const auto first = run(*used, 600);
  used->restore(snapshot);
  expect_same(first, run(*used, 600));
  const auto other = make(spec);
  other->restore(snapshot);
  expect_same(first, run(*other, 600));
}

TEST_P(Determinism, PendingPushIsPartOfASnapshot) {
  const auto instance = make(world("flat"));
  trot(*instance, 0, 300);
  instance->apply_push({0.1, 0, 0.05});
  const Snapshot snapshot = instance->save();
  const auto pushed = trot(*instance, 300, 320);
  instance->restore(snapshot);
  expect_same(pushed, trot(*instance, 300, 320));
}

TEST_P(Determinism, ContactsAndTorquesAreRestored) {
  const auto instance = make(world("flat"));
  trot(*instance, 0, 700);
  const Snapshot snapshot = instance->save();
  const LegArray<FootContact> feet = instance->foot_contacts();
  const JointVector torques = instance->torques();
  trot(*instance, 700, 900);
  instance->restore(snapshot);
  for (const Leg leg : kLegs) EXPECT_EQ(instance->foot_contacts()[leg].force, feet[leg].force);
  EXPECT_EQ(instance->torques(), torques);
}

TEST_P(Determinism, WorldsMayBeMadeOnAnyThread) {
  const auto expected = trot(*make(world("rough")), 0, 300);
  std::vector<std::vector<RobotState>> states(4);
  std::vector<std::thread> threads;
  for (auto& own : states) {
    threads.emplace_back(
        [&own, name = GetParam()] { own = trot(*make_world(name, world("rough")), 0, 300); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& own : states) expect_same(expected, own);
}

TEST_P(Determinism, RestoreForgetsWhatTheWorldDidBefore) {
  // Saved on the way down, before any contact; right after touch-down; and just after a push.
  for (const int instant : {5, 60, 401}) {
    const auto saved = make(world("rough")), other = make(world("rough"));
    trot(*saved, 0, instant);
    const Snapshot snapshot = saved->save();
    const auto expected = trot(*saved, instant, instant + 300);
    RobotState elsewhere = other->home_state();
    elsewhere.p_WB.z() += 0.01;
    elsewhere.q_WB = from_roll_pitch_yaw(0.2, -0.3, 1);
    other->reset(elsewhere);
    trot(*other, 0, 150);
    other->restore(snapshot);
    expect_same(expected, trot(*other, instant, instant + 300));
  }
}

TEST_P(Determinism, AFixedBaseIsPartOfASnapshot) {
  WorldSpec spec = scenes::world_of(scenes::awkward_robot());
  spec.fixed_base = true;
  const auto run = make(spec), other = make(spec);
  const JointTargets targets{JointVector::Constant(3, 0.4)};
  RobotState start = run->home_state();
  start.p_WB = {0.1, 0.2, 0.9};
  start.q_WB = from_roll_pitch_yaw(0.1, 0.2, 0.3);
  run->reset(start);
  ASSERT_EQ(run->step(targets, 100), StepStatus::kOk);
  const Snapshot snapshot = run->save();
  ASSERT_EQ(run->step(targets, 100), StepStatus::kOk);
  other->restore(snapshot);
  ASSERT_EQ(other->step(targets, 100), StepStatus::kOk);
  EXPECT_TRUE(same_bits(run->state(), other->state()));
}

TEST_P(Determinism, ForeignSnapshotsAreRefused) {
  const auto instance = make(world("flat"));
  Snapshot snapshot = instance->save();
  snapshot.engine_name = "abacus";
  EXPECT_THROW(instance->restore(snapshot), ConfigError);
  for (const std::string& name : available_engines()) {
    if (name == GetParam()) continue;
    EXPECT_THROW(instance->restore(make_world(name, world("flat"))->save()), ConfigError) << name;
  }
  const auto sled = make(scenes::sled());
  EXPECT_THROW(instance->restore(sled->save()), ConfigError);
}

}  // namespace
}  // namespace crossgait
