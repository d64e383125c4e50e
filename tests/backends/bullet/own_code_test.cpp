// `bullet`, whose rows and sweeps are Crossgait's, against the same by the code of Bullet's library.
#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "backends/bullet/bullet_backend.h"
#include "scenes/scenes.h"

namespace crossgait::bullet {
namespace {

struct Difference {
  double position = 0, force = 0;  // m; N, of all contacts together
  int counts = 0, most_contacts = 0;
};

template <typename Targets>
Difference run(const WorldSpec& spec, const RobotState* start, const Targets& targets, int steps) {
  const auto ours = native_engine().make(spec), bullets = own_engine().make(spec);
  if (start != nullptr) ours->reset(*start);
  if (start != nullptr) bullets->reset(*start);
  Difference result;
  for (int i = 0; i < steps; ++i) {
    const JointTargets now = targets(i * spec.physics_dt);
    EXPECT_EQ(ours->step(now), StepStatus::kOk);
    EXPECT_EQ(bullets->step(now), StepStatus::kOk);
    Vector3 force = Vector3::Zero();
    for (const Contact& c : ours->contacts()) force += c.force;
    for (const Contact& c : bullets->contacts()) force -= c.force;
    result.position = std::max(result.position, (ours->state().p_WB - bullets->state().p_WB).norm());
    result.force = std::max(result.force, force.norm());
    if (ours->contacts().count != bullets->contacts().count) ++result.counts;
    result.most_contacts = std::max(result.most_contacts, ours->contacts().count);
  }
  std::printf("measured bullet against bullet:own: %.2g m, %.2g N\n", result.position, result.force);
  return result;
}

// Rounding. A hundred times what was measured (4.9e-13 m on rough ground, 8e-9 N), to the next power of ten:
// both end their sweeps by one criterion, and where rounding makes one of them go on, by the tolerance.
void expect_same(const Difference& d, int contacts) {
  EXPECT_LT(d.position, 1e-10);
  EXPECT_LT(d.force, 1e-6);
  EXPECT_EQ(d.counts, 0);
  EXPECT_GE(d.most_contacts, contacts);
}

Difference trot(const scenes::RobotPtr& robot, const char* terrain = "flat") {
  WorldSpec spec = scenes::world_of(robot);
  spec.terrain = make_terrain(terrain);
  return run(
      spec, nullptr, [trot = scenes::Trot(*robot)](double time) { return trot.targets(time); }, 1500);
}

Difference hold(const WorldSpec& spec, const RobotState* start, int steps) {
  return run(
      spec, start, [home = scenes::home_targets(*spec.robot)](double) { return home; }, steps);
}

TEST(OwnCode, ATrotIsTheSame) {
  expect_same(trot(scenes::quadruped()), 4);
  expect_same(trot(scenes::quadruped(), "rough:seed=1,size_x=4,size_y=2"), 4);
}

TEST(OwnCode, DryJointsAreTheSame) {
  expect_same(trot(scenes::with_joint_friction(scenes::quadruped(), 0.02)), 4);
  expect_same(trot(scenes::with_joint_friction(scenes::serial_quadruped(), 0.2)), 4);
}

TEST(OwnCode, ManyContactsAreTheSame) {
  expect_same(hold(scenes::world_of(scenes::millipede(kMaxJoints, 1)), nullptr, 300), 32);
  WorldSpec sledge = scenes::world_of(scenes::heavy_sledge(32));
  sledge.gravity = {6.94, 0.5, -6.94};
  expect_same(hold(sledge, nullptr, 500), 32);
}

TEST(OwnCode, AFallIsTheSame) {
  const WorldSpec spec = scenes::world_of(scenes::assortment());
  RobotState start = native_engine().make(spec)->home_state();
  start.p_WB.z() += 0.1;
  start.q_WB = from_roll_pitch_yaw(0.3, 0.4, 0.5);
  start.w_WB = {2, -3, 1};
  expect_same(hold(spec, &start, 1000), 3);
}

TEST(OwnCode, HasAName) {
  EXPECT_EQ(find("bullet:own").value().name(), "bullet:own");
  EXPECT_EQ(find("bullet:own").value().info.laws.contact, "hard/sweeps");
  EXPECT_FALSE(find("bullet:own+surface"));
}

}  // namespace
}  // namespace crossgait::bullet
