// Bad input and worlds that explode: reported at once, never carried on, and gone after a reset.
#include <algorithm>
#include <cmath>
#include <functional>

#include <malloc.h>

#include "physics/core/error.h"
#include "tests/support/constants.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

using test::kInfinity;
using test::kNaN;

using scenes::identical;

/// What a ConfigError says, or "" if there is none.
std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

class BadInput : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(BadInput);

TEST_P(BadInput, TargetsOfTheWrongSizeOrNotFiniteChangeNothing) {
  const auto world = make(scenes::quadruped());
  const JointTargets good = scenes::home_targets(world->robot());
  ASSERT_EQ(world->step(good, 50), StepStatus::kOk);
  const RobotState before = world->state();
  JointTargets bad = good;
  for (const double value : {kNaN, kInfinity, -kInfinity}) {
    bad.q[7] = value;
    EXPECT_EQ(world->step(bad), StepStatus::kInvalidTargets);
  }
  EXPECT_EQ(world->step({}), StepStatus::kInvalidTargets);
  bad.q = JointVector::Zero(good.q.size() + 1);
  EXPECT_EQ(world->step(bad), StepStatus::kInvalidTargets);
  EXPECT_TRUE(identical(world->state(), before));
  // ... and the world goes on as if nothing had been asked.
  const auto undisturbed = make(scenes::quadruped());
  ASSERT_EQ(undisturbed->step(good, 100), StepStatus::kOk);
  ASSERT_EQ(world->step(good, 50), StepStatus::kOk);
  EXPECT_TRUE(identical(world->state(), undisturbed->state()));
}

TEST_P(BadInput, StatesAreRefusedByName) {
  const auto world = make(scenes::quadruped());
  const RobotState good = world->home_state(), before = world->state();
  const std::vector<std::pair<const char*, std::function<void(RobotState&)>>> faults{
      {"joint vectors", [](RobotState& s) { s.q.resize(3); }},
      {"joint vectors", [](RobotState& s) { s.qd.resize(0); }},
      {"state", [](RobotState& s) { s.p_WB.y() = kNaN; }},
      {"state", [](RobotState& s) { s.v_WB.x() = kInfinity; }},
      {"state", [](RobotState& s) { s.w_WB.z() = kNaN; }},
      {"state", [](RobotState& s) { s.q[5] = kNaN; }},
      {"state", [](RobotState& s) { s.qd[5] = 1e9; }},
      {"state", [](RobotState& s) { s.time = kNaN; }},
      {"state", [](RobotState& s) { s.q_WB.w() = kNaN; }},
      {"q_WB", [](RobotState& s) { s.q_WB.coeffs() *= 2; }},
      {"q_WB", [](RobotState& s) { s.q_WB.coeffs().setZero(); }},
  };
  for (const auto& [element, spoil] : faults) {
    RobotState bad = good;
    spoil(bad);
    EXPECT_NE(refusal([&] { world->reset(bad); }).find(element), std::string::npos) << element;
    EXPECT_TRUE(identical(world->state(), before));
  }
}

TEST_P(BadInput, WorldsAreRefusedByField) {
  const std::vector<std::pair<const char*, std::function<void(WorldSpec&)>>> faults{
      {"robot", [](WorldSpec& w) { w.robot = nullptr; }},
      {"physics_dt", [](WorldSpec& w) { w.physics_dt = 0; }},
      {"physics_dt", [](WorldSpec& w) { w.physics_dt = kNaN; }},
      {"gravity", [](WorldSpec& w) { w.gravity.x() = kNaN; }},
      {"friction", [](WorldSpec& w) { w.contact.friction = -0.1; }},
      {"impratio", [](WorldSpec& w) { w.contact.impratio = 0; }},
      {"time_constant", [](WorldSpec& w) { w.contact.softness.time_constant = 0; }},
      {"tolerance", [](WorldSpec& w) { w.solver.tolerance = kNaN; }},
      {"iterations", [](WorldSpec& w) { w.solver.iterations = 0; }},
  };
  for (const auto& [element, spoil] : faults) {
    WorldSpec bad = scenes::world_of(scenes::sled());
    spoil(bad);
    EXPECT_NE(refusal([&] { make(bad); }).find(element), std::string::npos) << element;
  }
}

TEST_P(BadInput, PushesAndBodiesAreChecked) {
  const auto world = make(scenes::quadruped());
  EXPECT_NE(refusal([&] { world->apply_push({0, kNaN, 0}); }), "");
  EXPECT_NE(refusal([&] { world->body_pose(-1); }), "");
  EXPECT_NE(refusal([&] { world->body_pose(21); }), "");
  EXPECT_NE(refusal([&] { world->body_inertia(21); }), "");
  EXPECT_EQ(refusal([&] { world->body_pose(20); }), "");
}

class Divergence : public EngineTest {
 protected:
  /// Servos so stiff that explicit torques must blow up.
  static WorldSpec explosive(double stiffness) {
    RobotDescription robot = *scenes::quadruped();
    for (Body& body : robot.bodies) {
      body.joint.kp = stiffness;
      body.joint.effort_limit = stiffness;
    }
    WorldSpec spec = scenes::world_of(scenes::finished(robot));
    spec.physics_dt = 2e-3;
    return spec;
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(Divergence);

TEST_P(Divergence, IsReportedSticksAndEndsWithAReset) {
  for (const double stiffness : {1e4, 1e6, 1e9}) {
    const auto world = make(explosive(stiffness));
    const JointTargets home = scenes::home_targets(world->robot());
    JointTargets off = home;
    off.q.array() += 0.1;
    int steps = 0;
    StepStatus status = StepStatus::kOk;
    for (; steps < 1000 && status == StepStatus::kOk; ++steps) status = world->step(off);
    ASSERT_EQ(status, StepStatus::kDiverged) << stiffness;
    measured("steps until it was noticed", steps);
    const RobotState last_good = world->state();
    EXPECT_TRUE(last_good.is_finite());
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(world->step(home), StepStatus::kDiverged);
      EXPECT_TRUE(identical(world->state(), last_good));
    }
    // Whether any are left is the engine's affair; none may carry what blew up.
    for (const Contact& c : world->contacts()) EXPECT_TRUE(c.force.allFinite());

    // In the air at home the servos have nothing to do, and nothing blows up at once.
    RobotState start = world->home_state();
    start.p_WB.z() = 1;
    const auto fresh = make(explosive(stiffness));
    fresh->reset(start);
    world->reset(start);
    EXPECT_TRUE(identical(world->state(), fresh->state()));
    for (int i = 0; i < 2; ++i) {
      EXPECT_EQ(world->step(home), fresh->step(home));
      EXPECT_TRUE(identical(world->state(), fresh->state()));
    }
    EXPECT_EQ((world->mass_matrix() - fresh->mass_matrix()).norm(), 0);
  }
}

TEST_P(Divergence, ASnapshotFromBeforeEndsItToo) {
  const auto world = make(scenes::quadruped());
  const JointTargets home = scenes::home_targets(world->robot());
  ASSERT_EQ(world->step(home, 100), StepStatus::kOk);
  const Snapshot saved = world->save();
  ASSERT_EQ(world->step(home, 100), StepStatus::kOk);
  const RobotState expected = world->state();
  RobotState wild = world->home_state();
  wild.p_WB.z() = 1;
  wild.w_WB = {9e3, -9e3, 9e3};
  wild.qd.setConstant(9e3);
  world->reset(wild);
  StepStatus status = StepStatus::kOk;
  for (int i = 0; i < 1000 && status == StepStatus::kOk; ++i) status = world->step(home);
  ASSERT_EQ(status, StepStatus::kDiverged);
  world->restore(saved);
  ASSERT_EQ(world->step(home, 100), StepStatus::kOk);
  EXPECT_TRUE(identical(world->state(), expected));
}

class Instances : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(Instances);

TEST_P(Instances, DoNotDisturbEachOther) {
  WorldSpec rough = scenes::world_of(scenes::quadruped());
  rough.terrain = make_terrain("rough:seed=3,size_x=2,size_y=2");
  const scenes::Trot trot(*scenes::quadruped());
  const auto alone = make(rough);
  for (int i = 0; i < 900; ++i) ASSERT_EQ(alone->step(trot.targets(i * 1e-3)), StepStatus::kOk);

  const auto first = make(rough);
  const auto other = make(scenes::long_quadruped());  // another robot, on the plane
  for (int i = 0; i < 900; ++i) {
    ASSERT_EQ(first->step(trot.targets(i * 1e-3)), StepStatus::kOk);
    ASSERT_EQ(other->step(scenes::home_targets(other->robot())), StepStatus::kOk);
    if (i % 100 == 0) {  // questions between steps change nothing either
      first->mass_matrix();
      first->body_pose(4);
      first->terrain_height(0.1, 0.1);
      first->save();
      const auto passing = make(rough);
      ASSERT_EQ(passing->step(trot.targets(0)), StepStatus::kOk);
    }
  }
  EXPECT_TRUE(identical(first->state(), alone->state()));
}

// Worlds give back what they take: what they leave behind would grow with every hundred of them. An engine
// may keep a stock of its own, and the allocator one of pieces, which the first some hundred fill.
TEST_P(Instances, LeaveNoMemoryBehind) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizers have an allocator of their own";
#endif
  const auto used = [] {
    const struct mallinfo2 info = ::mallinfo2();
    return static_cast<double>(info.uordblks + info.hblkhd);
  };
  const WorldSpec spec = scenes::world_of(scenes::quadruped());
  const JointTargets home = scenes::home_targets(*spec.robot);
  const auto make_and_forget = [&](int worlds) {
    for (int i = 0; i < worlds; ++i) {
      const auto world = make(spec);
      EXPECT_EQ(world->step(home, 5), StepStatus::kOk);
    }
  };
  make_and_forget(50);
  constexpr int kWorlds = 100;
  constexpr double kSmallest = 16;  // no object is smaller, bytes
  double left = kInfinity, before = used();
  for (int block = 0; block < 8 && left >= kSmallest; ++block) {
    make_and_forget(kWorlds);
    const double now = used();
    left = std::min(left, (now - before) / kWorlds);
    before = now;
  }
  measured("memory that a world leaves behind, bytes", left);
  EXPECT_LT(left, kSmallest);

  std::vector<std::unique_ptr<PhysicsBackend>> worlds;
  for (int i = 0; i < 20; ++i) worlds.push_back(make(spec));
  measured("memory of a world, kB", (used() - before) / 20 / 1024);
}

class StartsInTheGround : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(StartsInTheGround);

TEST_P(StartsInTheGround, AndIsNotThrownIntoTheAir) {
  // A ball, as deep as 20 mm: what a start on stairs, or a randomised one, may come to.
  constexpr double kRadius = 0.05;
  const std::string law = std::string(find_engine(GetParam()).info.laws.contact_law());
  double highest = 0;
  for (const double step : {5e-4, 1e-3, 2e-3}) {
    for (const double depth : {1e-3, 5e-3, 0.02}) {
      WorldSpec spec = scenes::world_of(scenes::block(ShapeType::kSphere, Vector3(kRadius, 0, 0)));
      spec.physics_dt = step;
      const auto world = make(spec);
      RobotState state = world->home_state();
      state.p_WB = {0, 0, kRadius - depth};
      world->reset(state);
      double fastest = 0;
      for (int i = 0; i < std::lround(1 / step); ++i) {
        ASSERT_EQ(world->step({}), StepStatus::kOk);
        fastest = std::max(fastest, world->state().v_WB.z());
        highest = std::max(highest, world->state().p_WB.z() - kRadius);
      }
      // A fifth of the depth per step, but no more than 0.3 m/s; the solver's tolerance.
      if (law == "hard" || law == "hard+pyramid") {
        EXPECT_NEAR(fastest, std::min(0.2 * depth / step, 0.3), 1e-6) << depth << ", " << step;
      }
    }
  }
  // From 0.3 m/s it rises by 4.6 mm; MuJoCo's spring lifts it no further than the ground.
  EXPECT_LT(highest, 0.01);
  measured("highest jump of a ball that starts up to 20 mm deep, m", highest);
}

}  // namespace
}  // namespace crossgait
