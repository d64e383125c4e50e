#include "motion/closed_loop.h"

#include "physics/core/error.h"
#include "tests/motion/motions.h"
#include "tests/support/engine_test.h"
#include "tests/support/motion_bits.h"

namespace crossgait {
namespace {

constexpr double kDt = 2e-3;  // s

/// A trot whose only state is its clock, so that a test can set it back.
class ClockedTrot final : public Controller {
 public:
  ClockedTrot(scenes::RobotPtr robot, double& clock)
      : robot_(std::move(robot)), trot_(*robot_), clock_(clock) {}

  RobotState initial_state(const Terrain& terrain, const Placement& placement) const override {
    RobotState state;
    state.q = robot_->home;
    state.qd = JointVector::Zero(robot_->joint_count());
    state.p_WB = {placement.x, placement.y,
                  terrain.height(placement.x, placement.y) + robot_->home_height + 0.01};
    return state;
  }
  void hold_pose(double /*dt*/, ControlTargets& out) override { out.joints = trot_.targets(0); }
  void advance(double dt, ControlTargets& out) override {
    clock_ += dt;
    out.joints = trot_.targets(scenes::Trot::kStand + clock_);
    out.contact_schedule.emplace();
    for (const Leg leg : kLegs) (*out.contact_schedule)[leg] = {scenes::Trot::swings(leg, clock_), 0.5};
    out.velocity = VelocityCommand{0.1, 0, 0};
  }

 private:
  scenes::RobotPtr robot_;
  scenes::Trot trot_;
  double& clock_;
};

Pushes now_and_then() {
  Random random(3);
  const Range interval{0.1, 0.4};
  return {{0.005, 0.02}, interval, random.uniform(interval.min, interval.max), 0, random};
}

class ClosedLoops : public EngineTest {
 protected:
  static WorldSpec rough() {
    WorldSpec spec = scenes::world_of(scenes::quadruped());
    spec.terrain = make_terrain("rough:seed=1,size_x=4,size_y=4");
    return spec;
  }
  static ClosedLoop loop_of(const WorldSpec& spec, double control_dt = kDt) {
    return {*spec.robot, {.control_dt = control_dt, .settle_seconds = 0.3}};
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(ClosedLoops);

TEST_P(ClosedLoops, ACopyWithASavedWorldGoesOnBitForBit) {
  const WorldSpec spec = rough();
  const auto world = make(spec), other = make(spec);
  double clock = 0;
  ClockedTrot source(spec.robot, clock);
  ClosedLoop loop = loop_of(spec);
  loop.start(*world, source, {{}, 0.2, now_and_then()});
  ASSERT_TRUE(loop.advance(*world, source, 333));

  const ClosedLoop saved = loop;
  const Snapshot snapshot = world->save();
  const double saved_clock = clock;
  loop.advance(*world, source, 500);
  const RobotState end = world->state();
  const MotionSummary motion = loop.statistics().summary(*world);
  EXPECT_GT(motion.distance_m, 0.05);
  EXPECT_NE(differences(motion, saved.statistics().summary(*world)), "");

  for (PhysicsBackend* again : {world.get(), other.get()}) {
    ClosedLoop copy = saved;
    again->restore(snapshot);
    clock = saved_clock;
    EXPECT_EQ(copy.time(), 333 * kDt);
    copy.advance(*again, source, 500);
    EXPECT_TRUE(scenes::identical(again->state(), end));
    EXPECT_EQ(differences(copy.statistics().summary(*again), motion), "");
    EXPECT_EQ(copy.time(), loop.time());
  }
}

TEST_P(ClosedLoops, OneStepAtATimeOrManyIsTheSame) {
  const WorldSpec spec = rough();
  const auto a = make(spec), b = make(spec);
  ClosedLoop many = loop_of(spec), one = loop_of(spec);
  double clock = 0;
  ClockedTrot source(spec.robot, clock);
  many.start(*a, source, {{}, 0, now_and_then()});
  many.advance(*a, source, 400);
  clock = 0;
  one.start(*b, source, {{}, 0, now_and_then()});
  for (int i = 0; i < 400; ++i) one.advance(*b, source, 1);
  EXPECT_TRUE(scenes::identical(a->state(), b->state()));
  EXPECT_EQ(differences(many.statistics().summary(*a), one.statistics().summary(*b)), "");
}

TEST_P(ClosedLoops, StartForgetsTheMotionBefore) {
  const WorldSpec spec = rough();
  const auto world = make(spec);
  double clock = 0;
  ClockedTrot source(spec.robot, clock);
  ClosedLoop loop = loop_of(spec);
  const auto run = [&] {
    clock = 0;
    loop.start(*world, source);
    EXPECT_EQ(loop.time(), 0);
    EXPECT_FALSE(loop.ended());
    loop.advance(*world, source, 300);
    return loop.statistics().summary(*world);
  };
  const MotionSummary first = run();
  // A motion that ends by itself in between.
  loop.start(*world, source, {{}, 0, motions::catastrophe(0.01)});
  EXPECT_FALSE(loop.advance(*world, source, 300));
  EXPECT_TRUE(loop.ended());
  const double ended_at = loop.time();
  EXPECT_LT(ended_at, 0.1);
  EXPECT_FALSE(loop.advance(*world, source, 300));  // and stays where it is
  EXPECT_EQ(loop.time(), ended_at);
  EXPECT_EQ(differences(run(), first), "");
}

TEST_P(ClosedLoops, RefuseStepsAndPlacesThatCannotBe) {
  const WorldSpec spec = rough();
  const auto world = make(spec);
  double clock = 0;
  ClockedTrot source(spec.robot, clock);
  ClosedLoop uneven = loop_of(spec, 1.5e-3);
  EXPECT_THROW(uneven.start(*world, source), ConfigError);
  ClosedLoop loop = loop_of(spec);
  EXPECT_THROW(loop.start(*world, source, {{.x = 3}, 0, {}}), ConfigError);
  EXPECT_NO_THROW(loop.start(*world, source, {{.x = 1}, 0, {}}));
}

TEST_P(ClosedLoops, TargetsHoldForAllPhysicsStepsOfAControlStep) {
  // Four physics steps to a control step, and as many asked for as that makes.
  WorldSpec spec = rough();
  spec.physics_dt = 0.5e-3;
  const auto world = make(spec);
  double clock = 0;
  ClockedTrot source(spec.robot, clock);
  ClosedLoop loop = loop_of(spec);
  loop.start(*world, source);
  EXPECT_NEAR(world->state().time, 0.3, 1e-12);  // a sum of 600 steps
  loop.advance(*world, source, 50);
  EXPECT_NEAR(clock, 50 * kDt, 1e-12);
  EXPECT_EQ(loop.statistics().summary(*world).physics_steps, 200);
}

}  // namespace
}  // namespace crossgait
