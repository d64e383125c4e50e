// Every outcome, reached in every engine by what a robot does there.
#include <cmath>
#include <functional>

#include "env/quadruped_env.h"
#include "physics/robot/hips.h"
#include "tests/motion/motions.h"
#include "tests/physics/robot/moved_base.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

using motions::at;

// A time step too long for loops whose time constant is 5 ms, s. Where their velocity bias counts they open
// at 12.5 ms and the engine diverges at 16, and hard ones at 12 and 20; elsewhere they open at 16 and at 20.
double step_that_opens_loops(const std::string& engine) {
  return find_engine(engine).info.laws.loops == "mujoco" ? 0.02 : 0.0125;
}

class Motion : public EngineTest {
 protected:
  static MotionSummary run(const WorldSpec& spec, const ControllerPtr& source, const WalkTiming& timing,
                           const Start& start = {}, const OutcomeSet& terminations = OutcomeSet::of_walks()) {
    const auto world = make(spec);
    return run_walk(*world, source, timing, {}, start, terminations);
  }
  static MotionSummary trot(const WorldSpec& spec, double seconds,
                            const std::optional<VelocityCommand>& command = {}) {
    return run(spec, motions::trot(spec.robot, command), {.seconds = seconds});
  }
  static WorldSpec flat() { return scenes::world_of(scenes::quadruped()); }
};
CROSSGAIT_FOR_EVERY_BACKEND(Motion);

TEST_P(Motion, WalksWhereNothingHappens) {
  const MotionSummary m = trot(flat(), 3);
  EXPECT_EQ(m.outcome, Outcome::kWalked);
  for (const auto& first : m.first_at_s) EXPECT_FALSE(first.has_value());
  EXPECT_FALSE(m.failed());
}

TEST_P(Motion, DivergesAtTheStepThatDoesAndEndsThere) {
  const MotionSummary m =
      run(flat(), motions::trot(scenes::quadruped()), {.seconds = 1}, {{}, 0, motions::catastrophe(0.1)});
  EXPECT_EQ(m.outcome, Outcome::kDiverged);
  EXPECT_TRUE(m.failed());
  // The push acts in the step that begins at 0.1 s; engines may take some more to notice, but not many.
  EXPECT_GE(at(m, Outcome::kDiverged), 0.1 - 1e-12);
  EXPECT_LT(at(m, Outcome::kDiverged), 0.15);
  EXPECT_EQ(m.simulated_seconds, at(m, Outcome::kDiverged));
  EXPECT_TRUE(m.final_position_m.allFinite());
}

TEST_P(Motion, ThatDivergesWhileItSettlesEndsBeforeItBegins) {
  WorldSpec spec = flat();
  spec.gravity = {0, 0, -1e9};
  int samples = 0;
  const auto world = make(spec);
  const MotionSummary m = run_walk(*world, motions::trot(spec.robot), {.seconds = 1}, [&](const WalkSample&) {
    ++samples;
    return true;
  });
  EXPECT_EQ(m.outcome, Outcome::kDiverged);
  EXPECT_EQ(at(m, Outcome::kDiverged), 0);
  EXPECT_EQ(m.physics_steps, 0);
  EXPECT_EQ(m.simulated_seconds, 0);
  EXPECT_EQ(m.mean_speed_mps, 0);
  EXPECT_EQ(samples, 0);
}

TEST_P(Motion, ComesApartWhereTheTimeStepIsTooLongForItsLoops) {
  WorldSpec spec = flat();
  spec.physics_dt = step_that_opens_loops(GetParam());
  const MotionSummary m = run(spec, motions::trot(spec.robot), {.seconds = 2, .control_dt = spec.physics_dt});
  EXPECT_EQ(m.outcome, Outcome::kLoopViolated);
  EXPECT_TRUE(m.failed());
  EXPECT_GT(m.max_loop_gap_m, OutcomeLimits{}.loop_gap * spec.robot->home_height);
  EXPECT_NEAR(m.simulated_seconds, 2, spec.physics_dt);  // which ends no walk
  measured("largest loop gap, m", m.max_loop_gap_m);
}

TEST_P(Motion, FallsWhenItIsPutDownOnItsSide) {
  const Start start{{.roll = 1.5}, 0, {}};
  const WalkTiming timing{.seconds = 1, .settle_seconds = 0};
  const ControllerPtr source = motions::standing(scenes::quadruped());
  const MotionSummary m = run(flat(), source, timing, start);
  EXPECT_EQ(m.outcome, Outcome::kFell);
  EXPECT_DOUBLE_EQ(at(m, Outcome::kFell), timing.control_dt);  // from the first step on
  EXPECT_DOUBLE_EQ(m.simulated_seconds, 1);
  // Then it lies on its trunk, which is the lesser of two evils.
  EXPECT_GE(at(m, Outcome::kCollapsed), OutcomeLimits{}.low_seconds - 1e-12);
  const MotionSummary ended = run(flat(), source, timing, start, OutcomeSet().add(Outcome::kFell));
  EXPECT_DOUBLE_EQ(ended.simulated_seconds, timing.control_dt);
}

TEST_P(Motion, CollapsesWhereServosAreTooWeakAfterHalfASecondDown) {
  // Every physics step is a control step here, so that the observer sees what the definition is about.
  const scenes::RobotPtr weak = motions::weak_quadruped();
  const auto world = make(weak);
  const ControllerPtr source = motions::standing(weak);
  const Vector3 hips = hip_middle(*weak);
  const double h = 1e-3, standing = source->initial_state(Terrain(), {}).p_WB.z() + hips.z(),
               weight = weak->total_mass() * 9.81;
  double load = 0, expected = -1;  // of all but feet, smoothed, N; s
  int steps = 0, low_steps = 0;
  const auto watch = [&](const WalkSample& sample) {
    ++steps;
    double other = 0;
    for (const Contact& c : sample.world.contacts()) other += c.leg < 0 ? c.force.z() : 0;
    load += h / (0.1 + h) * (other - load);
    const bool low = (sample.world.state().X_WB() * hips).z() < 0.5 * standing || load > 0.5 * weight;
    low_steps = low ? low_steps + 1 : 0;
    if (low_steps == 500 && expected < 0) expected = steps * h;
    return true;
  };
  const MotionSummary m =
      run_walk(*world, source, {.seconds = 2, .control_dt = h, .settle_seconds = 0}, watch);
  EXPECT_EQ(m.outcome, Outcome::kCollapsed);
  EXPECT_TRUE(m.failed());
  EXPECT_FALSE(m.has(Outcome::kFell));
  ASSERT_GT(expected, 0.5);
  EXPECT_DOUBLE_EQ(at(m, Outcome::kCollapsed), expected);
  EXPECT_DOUBLE_EQ(m.simulated_seconds, 2);
}

TEST_P(Motion, CollapsesOntoItsTrunkHoweverHighThatIs) {
  // By the load alone: with the limit on height out of the way, on feet that are drawn up and hold nothing.
  const scenes::RobotPtr weak = motions::weak_quadruped();
  const double weight = weak->total_mass() * 9.81;
  OutcomeLimits limits;
  limits.low_height = -1;  // never: on its back, hips are on the ground
  const auto world = make(weak);
  const auto source = motions::functions_of(motions::standing(weak, 0.04));
  source->on_stand = [stand = source->on_stand](const Terrain& terrain, const Placement& placement) {
    RobotState state = stand(terrain, placement);
    state.p_WB.z() = 0.1;  // the trunk clear of the ground too
    return state;
  };
  ClosedLoop loop(*weak, {.control_dt = 1e-3, .settle_seconds = 0, .limits = limits});
  loop.start(*world, *source, {{.roll = M_PI}, 0, {}});  // on its back, where no foot carries anything
  double load = 0, expected = -1;
  int low_steps = 0;
  for (int i = 1; i <= 1500; ++i) {
    loop.advance(*world, *source, 1);
    double other = 0;
    for (const Contact& c : world->contacts()) other += c.leg < 0 ? c.force.z() : 0;
    load += 1e-3 / (0.1 + 1e-3) * (other - load);
    low_steps = load > 0.5 * weight ? low_steps + 1 : 0;
    if (low_steps == 500 && expected < 0) expected = i * 1e-3;
  }
  ASSERT_GT(expected, 0.5);
  EXPECT_DOUBLE_EQ(at(loop.statistics().summary(*world), Outcome::kCollapsed), expected);
}

// Some files have the base's frame on the ground between the feet, or below it: lengths by which a motion is
// judged are the robot's, and so is what becomes of it.
TEST_P(Motion, ComesToTheSameEndWhereverTheBaseHasItsFrame) {
  const double leg = leg_length(*scenes::quadruped());
  for (const double up : {0.0, -leg, -1.5 * leg, 2 * leg}) {
    const scenes::RobotPtr moved = std::make_shared<RobotDescription>(
        with_base_frame(*scenes::quadruped(), Pose(Eigen::Translation3d(0.05, 0, up))));
    EXPECT_NEAR(leg_length(*moved), leg, 1e-12);  // rounding
    const MotionSummary m = run(scenes::world_of(moved), motions::trot(moved), {.seconds = 2});
    EXPECT_EQ(m.outcome, Outcome::kWalked) << up;
    RobotDescription weak = *moved;
    for (Body& body : weak.bodies) body.joint.effort_limit *= 0.01;
    const scenes::RobotPtr fallen = std::make_shared<RobotDescription>(weak);
    EXPECT_EQ(run(scenes::world_of(fallen), motions::trot(fallen), {.seconds = 2}).outcome,
              Outcome::kCollapsed)
        << up;
  }
}

TEST_P(Motion, LeavesASmallFieldWhenItsBaseDoes) {
  // Sliding so fast that it is over the edge before it tips over it.
  WorldSpec spec = motions::inclined(0.3, 0.03);
  spec.terrain = make_terrain("slope:angle=0,size_x=1.4,size_y=2");
  const auto world = make(spec);
  const WalkTiming timing{.seconds = 1.5, .settle_seconds = 0};
  double left_at = -1;
  int steps = 0;
  const auto watch = [&](const WalkSample& sample) {
    ++steps;
    const Vector3& p = sample.world.state().p_WB;
    if (left_at < 0 && std::max(std::abs(p.x()) - 0.7, std::abs(p.y()) - 1) > 0) left_at = 2e-3 * steps;
    return true;
  };
  const MotionSummary m =
      run_walk(*world, motions::standing(spec.robot), timing, watch, {}, OutcomeSet::of_names({}));
  ASSERT_GT(left_at, 0.5);  // 0.7 m at 2.6 m/s^2
  EXPECT_DOUBLE_EQ(at(m, Outcome::kLeftTerrain), left_at);
  EXPECT_DOUBLE_EQ(m.simulated_seconds, 1.5);
  // Unless told otherwise a walk ends there.
  const MotionSummary ended = run(spec, motions::standing(spec.robot), timing);
  EXPECT_EQ(ended.outcome, Outcome::kLeftTerrain);
  EXPECT_FALSE(ended.failed());
  EXPECT_DOUBLE_EQ(ended.simulated_seconds, left_at);
}

TEST_P(Motion, SlidesDownASlipperySlope) {
  // Friction of a tenth of what would hold it: a t^2 / 2 = 1.4 m in a second.
  const WorldSpec spec = motions::inclined(0.3, 0.03);
  const MotionSummary m = run(spec, motions::standing(spec.robot), {.seconds = 1, .settle_seconds = 0});
  EXPECT_EQ(m.outcome, Outcome::kSlid);
  EXPECT_FALSE(m.failed());
  EXPECT_GT(m.path_m, 1);
  EXPECT_NEAR(m.slip_m / kLegCount, m.path_m, 0.25 * m.path_m);  // all of the way, on all its feet
  EXPECT_FALSE(at(m, Outcome::kSlid) >= 0);                      // known at the end alone
}

TEST_P(Motion, FeetThatAreMeantToSwingAreDraggedAndDoNotSlide) {
  const WorldSpec spec = motions::inclined(0.3, 0.03);
  const auto swinging = motions::functions_of(motions::standing(spec.robot));
  swinging->on_advance = [stand = swinging->on_advance](double dt, ControlTargets& out) {
    stand(dt, out);
    out.contact_schedule.emplace();
    out.contact_schedule->fill({.swing = true, .progress = 0.5});
  };
  const MotionSummary m = run(spec, swinging, {.seconds = 1, .settle_seconds = 0});
  EXPECT_EQ(m.outcome, Outcome::kWalked);
  EXPECT_GT(m.path_m, 1);
  EXPECT_GT(m.swing_contact_ratio.value(), 0.9);
}

TEST_P(Motion, SlidingIsWorseThanMakingNoWay) {
  // Towards +x, on feet that are meant to go back.
  const WorldSpec spec = motions::inclined(0.3, 0.03);
  const auto back = motions::functions_of(motions::standing(spec.robot));
  back->on_advance = [stand = back->on_advance](double dt, ControlTargets& out) {
    stand(dt, out);
    out.velocity = VelocityCommand{-0.15, 0, 0};
  };
  const WalkTiming timing{.seconds = 1, .settle_seconds = 0};
  EXPECT_EQ(run(spec, back, timing).outcome, Outcome::kSlid);
  // On level ground the same is no progress.
  EXPECT_EQ(run(flat(), back, timing).outcome, Outcome::kNoProgress);
}

TEST_P(Motion, MakesNoProgressOnIce) {
  WorldSpec spec = flat();
  spec.contact.friction = 0;
  const MotionSummary ahead = trot(spec, 3), asked = trot(spec, 3, VelocityCommand{0.1, 0, 0});
  EXPECT_EQ(ahead.outcome, Outcome::kNoProgress);
  EXPECT_EQ(asked.outcome, Outcome::kNoProgress);
  EXPECT_LT(std::abs(asked.distance_m), 0.2 * 0.3);
  // 0.6 m/s to the left, where a trot has no way to go either.
  EXPECT_EQ(trot(spec, 3, VelocityCommand{0, 0.05, 0}).outcome, Outcome::kNoProgress);
  // Turning counts where no way was asked for.
  EXPECT_EQ(trot(spec, 3, VelocityCommand{0, 0, 0.5}).outcome, Outcome::kNoProgress);
  EXPECT_EQ(trot(flat(), 3, VelocityCommand{0, 0, -0.5}).outcome, Outcome::kWalked);
  // Too little was asked for to judge by.
  EXPECT_EQ(trot(spec, 1, VelocityCommand{0.05, 0, 0}).outcome, Outcome::kWalked);
}

TEST_P(Motion, NothingIsWorseThanDivergence) {
  const Start start{{.roll = 1.5}, 0, motions::catastrophe(0.7)};
  const MotionSummary m =
      run(flat(), motions::standing(scenes::quadruped()), {.seconds = 1, .settle_seconds = 0}, start);
  EXPECT_TRUE(m.has(Outcome::kFell));
  EXPECT_TRUE(m.has(Outcome::kCollapsed));
  EXPECT_EQ(m.outcome, Outcome::kDiverged);
}

class EpisodeEnds : public EngineTest {
 protected:
  struct Case {
    Outcome outcome;
    EnvConfig config;
    std::function<void(WorldSpec&)> change = [](WorldSpec&) {};
  };

  // Worlds in which the zero policy comes to an early end, whatever the engine.
  static std::vector<Case> cases() {
    EnvConfig plain;
    plain.episode_seconds = 3;
    plain.reward.fill(0);
    plain.reward[find_reward_term("termination")] = -10;
    EnvConfig coarse = plain;
    coarse.physics_dt = coarse.control_dt = coarse.policy_dt = step_that_opens_loops(GetParam());
    EnvConfig toppled = plain;
    toppled.tilt_limit_deg = 1.5;  // a trot pitches by 5 degrees
    EnvConfig small = plain;       // stands, and slides off
    small.terrain = "slope:angle=0,size_x=1.4,size_y=2";
    small.settle_seconds = 0;
    small.command = VelocityCommand{};
    EnvConfig pushed = plain;  // to four times the speed of sound
    pushed.randomisation[Randomised::kPushImpulse] = {10, 10};
    pushed.randomisation[Randomised::kPushInterval] = {0.1, 0.1};
    return {{Outcome::kDiverged, pushed, [](WorldSpec& w) { w.robot = motions::light_quadruped(); }},
            {Outcome::kLoopViolated, coarse},
            {Outcome::kFell, toppled},
            {Outcome::kCollapsed, plain, [](WorldSpec& w) { w.robot = motions::weak_quadruped(); }},
            {Outcome::kLeftTerrain, small, [](WorldSpec& w) {
               const WorldSpec ramp = motions::inclined(0.3, 0.03);
               w.gravity = ramp.gravity;
               w.contact = ramp.contact;
             }}};
  }

  struct Episode {
    MotionSummary motion;
    std::vector<StepResult> steps;
    Outcome outcome;  // as the last step's info has it
  };
  static Episode run(const Case& c) {
    QuadrupedEnv env(c.config, with_change(find_engine(GetParam()), c.change));
    std::vector<double> seen(env.observation_size()), zeros(env.action_size(), 0);
    env.reset(0, seen);
    Episode episode;
    do {
      episode.steps.push_back(env.step(zeros, seen));
      for (const double x : seen) EXPECT_TRUE(std::isfinite(x));
    } while (!episode.steps.back().done());
    episode.motion = env.summary();
    episode.outcome = env.info().outcome;
    // Nothing more comes of it.
    EXPECT_EQ(env.step(zeros, seen).reward, 0);
    return episode;
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(EpisodeEnds);

TEST_P(EpisodeEnds, EveryEarlyEndCostsTheSame) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(name(c.outcome));
    const Episode e = run(c);
    EXPECT_EQ(e.outcome, c.outcome);
    EXPECT_EQ(e.motion.outcome, c.outcome);
    EXPECT_TRUE(e.steps.back().terminated);
    EXPECT_FALSE(e.steps.back().truncated);
    EXPECT_LT(e.motion.simulated_seconds, c.config.episode_seconds);
    EXPECT_EQ(e.motion.simulated_seconds, at(e.motion, c.outcome));
    for (const StepResult& step : e.steps) EXPECT_EQ(step.reward, step.terminated ? -10 : 0);
  }
}

TEST_P(EpisodeEnds, AreThoseThatAreConfigured) {
  for (Case& c : cases()) {
    SCOPED_TRACE(name(c.outcome));
    c.config.terminations = OutcomeSet();
    const Episode e = run(c);
    EXPECT_TRUE(e.motion.has(c.outcome));
    const bool always = c.outcome == Outcome::kDiverged;
    EXPECT_EQ(e.steps.back().terminated, always);
    EXPECT_EQ(e.steps.back().truncated, !always);
    if (!always) {
      EXPECT_DOUBLE_EQ(e.motion.simulated_seconds, c.config.episode_seconds);
    }
    for (const StepResult& step : e.steps) EXPECT_EQ(step.reward, step.terminated ? -10 : 0);
  }
}

}  // namespace
}  // namespace crossgait
