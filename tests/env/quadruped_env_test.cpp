#include "env/quadruped_env.h"

#include <limits>

#include "motion/gait_source.h"
#include "motion/walk.h"
#include "physics/core/error.h"
#include "tests/support/constants.h"
#include "tests/support/engine_test.h"
#include "tests/support/environments.h"

namespace crossgait {
namespace {

using test::kNaN;

class Environment : public EngineTest {
 protected:
  static QuadrupedEnv make_env(const EnvConfig& config = {}) {
    return QuadrupedEnv(config, find_engine(GetParam()));
  }
  static std::vector<double> zeros(const QuadrupedEnv& env) {
    return std::vector<double>(env.action_size(), 0);
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(Environment);

TEST_P(Environment, AZeroPolicyIsThePlainGait) {
  // The environment's physics is that of `crossgait walk` step for step.
  EnvConfig config;
  config.episode_seconds = 2;
  QuadrupedEnv env = make_env(config);
  std::vector<double> seen(env.observation_size());
  env.reset(0, seen);
  while (!env.step(zeros(env), seen).done()) {
  }
  const auto world = make(scenes::quadruped());
  const MotionSummary walk =
      run_walk(*world, make_gait_controller(choose_gait("trot", {}), world->spec()), {.seconds = 2});
  EXPECT_TRUE(scenes::identical(env.world().state(), world->state()));
  EXPECT_EQ(env.info().distance, walk.distance_m);
  EXPECT_EQ(env.info().time, 2);
  EXPECT_EQ(env.info().limit_factor, 1);
  EXPECT_EQ(env.info().ik_clamped, 0);
}

TEST_P(Environment, ATurnThatIsCommandedLaterIsFollowed) {
  // Heading hold knows of it: it would hold on to the first heading otherwise.
  QuadrupedEnv env = make_env({});
  std::vector<double> seen(env.observation_size());
  env.reset(0, seen);
  env.set_command({0.1, 0, 0.4});
  for (int i = 0; i < 1500; ++i) env.step(zeros(env), seen);  // 3 s
  EXPECT_NEAR(env.info().roll_pitch_yaw.z(), 1.2, 0.06);
}

TEST_P(Environment, HeadingHoldCanBeSwitchedOff) {
  // The first strides turn the robot by some degrees; without feedback it goes on like that.
  const auto turned = [](bool hold) {
    EnvConfig config;
    config.heading_hold = hold;
    config.command = VelocityCommand{0.35, 0, 0};
    QuadrupedEnv env = make_env(config);
    std::vector<double> seen(env.observation_size());
    env.reset(0, seen);
    for (int i = 0; i < 3000; ++i) env.step(zeros(env), seen);  // 6 s
    return std::abs(env.info().roll_pitch_yaw.z());
  };
  EXPECT_LT(turned(true), 0.5 * turned(false));
}

TEST_P(Environment, ClipsActionsBeforeAnythingSeesThem) {
  EnvConfig config;
  config.observation.emplace_back("last_action");
  config.reward.fill(1);
  QuadrupedEnv clipped = make_env(config), beyond = make_env(config);
  std::vector<double> a(clipped.observation_size()), b(a), within(clipped.action_size()), outside(within);
  clipped.reset(0, a);
  beyond.reset(0, b);
  for (int step = 0; step < 3; ++step) {
    for (std::size_t i = 0; i < within.size(); ++i) {
      within[i] = (i + static_cast<std::size_t>(step)) % 2 == 0 ? 1 : -1;
      outside[i] = within[i] * (1.5 + static_cast<double>(i));
    }
    EXPECT_EQ(clipped.step(within, a).reward, beyond.step(outside, b).reward);
    EXPECT_EQ(a, b);
  }
  const std::size_t first = *clipped.observation_layout().find("last.delta.step_height");
  EXPECT_EQ(std::abs(b[first]), 1);
}

TEST_P(Environment, EndsByTimeAsTruncated) {
  EnvConfig config;
  config.episode_seconds = 0.1;
  config.policy_dt = 0.02;
  QuadrupedEnv env = make_env(config);
  std::vector<double> seen(env.observation_size());
  for (int episode = 0; episode < 2; ++episode) {
    env.reset(0, seen);
    for (int i = 0; i < 5; ++i) {
      const StepResult r = env.step(zeros(env), seen);
      EXPECT_EQ(r.truncated, i == 4);
      EXPECT_FALSE(r.terminated);
      EXPECT_NE(r.reward, 0);
    }
    const std::vector<double> last = seen;
    const StepResult after = env.step(zeros(env), seen);
    EXPECT_TRUE(after.truncated);
    EXPECT_EQ(after.reward, 0);
    EXPECT_EQ(seen, last);  // nothing moves after the end
  }
}

TEST_P(Environment, EndsByTiltingAndByLeavingTheGround) {
  EnvConfig config;
  config.tilt_limit_deg = 1.5;  // a trot pitches by 5 degrees
  QuadrupedEnv tilting = make_env(config);
  std::vector<double> seen(tilting.observation_size());
  tilting.reset(0, seen);
  StepResult r;
  while (!(r = tilting.step(zeros(tilting), seen)).done()) {
  }
  EXPECT_TRUE(r.terminated);
  EXPECT_EQ(tilting.info().outcome, Outcome::kFell);
  EXPECT_GT(tilting.info().roll_pitch_yaw.head<2>().cwiseAbs().maxCoeff() * 180 / M_PI, 1.5);
  EXPECT_LT(tilting.info().time, 2);

  EnvConfig small;
  small.terrain = "rough:size_x=.4,size_y=.4,amplitude=.002";
  small.reward.fill(0);
  small.reward[find_reward_term("termination")] = -10;
  QuadrupedEnv leaving = make_env(small);
  leaving.reset(0, seen);
  while (!(r = leaving.step(zeros(leaving), seen)).done()) EXPECT_EQ(r.reward, 0);
  EXPECT_TRUE(r.terminated);
  // A leg that hangs over the edge, 0.2 m ahead, may tilt or tear the robot just before its base is beyond.
  const Outcome outcome = leaving.info().outcome;
  EXPECT_TRUE(outcome == Outcome::kLeftTerrain || outcome == Outcome::kFell ||
              outcome == Outcome::kLoopViolated);
  // Its feet are over the edge when it has come half as far.
  EXPECT_GT(leaving.info().distance, 0.1);
  EXPECT_EQ(r.reward, -10);
  for (const double x : seen) EXPECT_TRUE(std::isfinite(x));
}

TEST_P(Environment, ActionsAreClippedAndNonsenseCountsAsZero) {
  QuadrupedEnv env = make_env(), clipped = make_env();
  std::vector<double> a(env.observation_size()), b(a.size());
  env.reset(0, a);
  clipped.reset(0, b);
  const double huge = std::numeric_limits<double>::infinity();
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    std::vector<double> action = scenes::random_action(random, env.action_size()), tame = action;
    action[1] = 1e300;
    tame[1] = 1;
    action[4] = -7;
    tame[4] = -1;
    action[2] = kNaN;
    action[5] = -huge;
    tame[2] = tame[5] = 0;
    EXPECT_EQ(env.step(action, a).reward, clipped.step(tame, b).reward);
    EXPECT_EQ(a, b);
    EXPECT_EQ(env.info().invalid_actions, 2);
    EXPECT_EQ(env.info().clipped_actions, 2);
    EXPECT_EQ(clipped.info().invalid_actions, 0);
    EXPECT_EQ(clipped.info().clipped_actions, 0);
    for (const double x : a) EXPECT_TRUE(std::isfinite(x));
  }
}

TEST_P(Environment, WrongSizesAreErrorsThatChangeNothing) {
  QuadrupedEnv env = make_env();
  std::vector<double> seen(env.observation_size()), small(seen.size() - 1);
  env.reset(0, seen);
  const RobotState before = env.world().state();
  std::vector<double> action = zeros(env);
  action.push_back(0);
  EXPECT_THROW(env.step(action, seen), ConfigError);
  EXPECT_THROW(env.step(zeros(env), small), ConfigError);
  EXPECT_THROW(env.reset(0, small), ConfigError);
  EXPECT_THROW(env.set_command({kNaN, 0, 0}), ConfigError);
  EXPECT_TRUE(scenes::identical(env.world().state(), before));
}

TEST_P(Environment, DeltasMoveParametersByTheirScaleUpToTheirRange) {
  QuadrupedEnv env = make_env();
  std::vector<double> seen(env.observation_size()), action = zeros(env);
  env.reset(0, seen);
  action[1] = 1;  // delta.step_length
  const ParameterRow& row = find_parameter("step_length");
  const double initial = find_gait("trot").preferred.step_length;
  double expected = initial;
  for (int i = 0; i < 12; ++i) {  // 0.04 + 10 x 0.008 reaches 0.12
    env.step(action, seen);
    expected = std::min(expected + row.delta_scale, row.max);
    EXPECT_DOUBLE_EQ(env.info().parameters->step_length, expected);
  }
  EXPECT_EQ(env.info().parameters->step_length, row.max);
  env.reset(0, seen);
  EXPECT_EQ(env.info().parameters->step_length, initial);
}

TEST_P(Environment, FollowsItsCommand) {
  EnvConfig config;
  config.command = VelocityCommand{0.15, 0, 0};
  QuadrupedEnv env = make_env(config);
  std::vector<double> seen(env.observation_size());
  env.reset(0, seen);
  for (int i = 0; i < 1500; ++i) env.step(zeros(env), seen);
  EXPECT_NEAR(env.info().distance, 3 * 0.15, 0.06);  // measured 0.43: the first stride grows from standing
  env.set_command({0, 0, 0});
  for (int i = 0; i < 1000; ++i) env.step(zeros(env), seen);
  EXPECT_LT(env.world().state().v_WB.norm(), 0.02);  // stands
  env.reset(0, seen);
  for (int i = 0; i < 1500; ++i) env.step(zeros(env), seen);
  EXPECT_GT(env.info().distance, 0.3);  // the configured command again
}

TEST_P(Environment, RandomisedStartsAreWhereTheyWereDrawn) {
  EnvConfig config;
  config.terrain = "rough";
  config.settle_seconds = 0.2;
  config.randomisation[Randomised::kStartX] = {0.3, 0.5};
  config.randomisation[Randomised::kStartY] = {-0.5, -0.3};
  config.randomisation[Randomised::kStartYaw] = {1, 2};
  QuadrupedEnv env = make_env(config);
  std::vector<double> seen(env.observation_size());
  double last = 0;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    env.reset(seed, seen);
    const RobotState& s = env.world().state();
    EXPECT_NEAR(s.p_WB.x(), 0.4, 0.13);  // settling on rough ground moves it some
    EXPECT_NEAR(s.p_WB.y(), -0.4, 0.13);
    EXPECT_NEAR(roll_pitch_yaw(s.q_WB).z(), 1.5, 0.6);
    EXPECT_NE(s.p_WB.x(), last);
    last = s.p_WB.x();
    // Distances and yaw count from there.
    EXPECT_EQ(env.info().distance, 0);
    EXPECT_NEAR(env.info().roll_pitch_yaw.z(), 0, 1e-12);
  }
  for (int i = 0; i < 1000; ++i) env.step(zeros(env), seen);
  EXPECT_GT(env.info().distance, 0.15);  // forward is where it faced
  config.randomisation[Randomised::kStartX] = {50, 60};
  QuadrupedEnv beyond = make_env(config);
  EXPECT_THROW(beyond.reset(0, seen), ConfigError);
  EXPECT_THROW(beyond.step(zeros(beyond), seen), ConfigError);  // a reset that failed begins nothing
}

TEST_P(Environment, RandomisedWorldsAreTheirSeeds) {
  EnvConfig config;
  config.terrain = "rough";
  config.randomisation[Randomised::kTerrainSeed] = {0, 100};
  config.randomisation[Randomised::kFriction] = {0.8, 1.2};
  config.randomisation[Randomised::kMass] = {0.9, 1.1};
  config.randomisation[Randomised::kServoStiffness] = {0.9, 1.1};
  config.randomisation[Randomised::kPushImpulse] = {0.01, 0.02};
  config.randomisation[Randomised::kPushInterval] = {0.1, 0.2};
  config.randomisation[Randomised::kStartPhase] = {0, 1};
  QuadrupedEnv env = make_env(config);
  std::vector<double> seen(env.observation_size());
  std::vector<std::vector<double>> runs;
  for (const std::uint64_t seed : {3U, 4U, 3U}) {
    env.reset(seed, seen);
    Random random(9);
    runs.push_back(scenes::record(env, random, 300));
  }
  EXPECT_NE(runs[0], runs[1]);
  EXPECT_EQ(runs[0], runs[2]);
}

TEST_P(Environment, PushesMoveTheRobot) {
  EnvConfig config;
  config.randomisation[Randomised::kPushImpulse] = {0.1, 0.1};
  config.randomisation[Randomised::kPushInterval] = {0.5, 0.5};
  QuadrupedEnv pushed = make_env(config), calm = make_env();
  std::vector<double> a(pushed.observation_size()), b(a.size());
  pushed.reset(0, a);
  calm.reset(0, b);
  for (int i = 0; i < 250; ++i) {
    pushed.step(zeros(pushed), a);
    calm.step(zeros(calm), b);
  }
  EXPECT_EQ(a, b);  // up to half a second
  pushed.step(zeros(pushed), a);
  calm.step(zeros(calm), b);
  const Vector3 kick = pushed.world().state().v_WB - calm.world().state().v_WB;
  // An impulse of 0.1 N s on 0.75 kg whose feet hold on to the ground: tens of mm/s.
  EXPECT_GT(kick.norm(), 0.02);
}

TEST_P(Environment, RestoringContinuesBitForBit) {
  for (const bool randomised : {false, true}) {
    EnvConfig config;
    config.terrain = "rough";
    config.randomisation[Randomised::kPushImpulse] = {0.01, 0.02};
    config.randomisation[Randomised::kPushInterval] = {0.1, 0.2};
    if (randomised) {
      config.randomisation[Randomised::kTerrainSeed] = {0, 100};
      config.randomisation[Randomised::kTrunkMass] = {0.9, 1.1};
    }
    QuadrupedEnv env = make_env(config), other = make_env(config);
    std::vector<double> seen(env.observation_size());
    env.reset(1, seen);
    Random random(2);
    scenes::record(env, random, 400);
    const auto saved = env.save();
    const Random at_save = random;
    const std::vector<double> straight = scenes::record(env, random, 400);
    other.reset(77, seen);
    for (QuadrupedEnv* again : {&env, &other}) {
      again->restore(*saved);
      random = at_save;
      EXPECT_EQ(scenes::record(*again, random, 400), straight);
    }
  }
}

TEST_P(Environment, RefusesSnapshotsOfAnother) {
  EnvConfig other;
  other.adapt = {"step_length"};
  QuadrupedEnv saved = make_env(other);
  std::vector<double> seen(saved.observation_size());
  saved.reset(0, seen);
  EXPECT_THROW(make_env().restore(*saved.save()), ConfigError);
}

TEST_P(Environment, NothingMovesBeforeTheFirstReset) {
  QuadrupedEnv env = make_env();
  std::vector<double> seen(env.observation_size());
  const RobotState before = env.world().state();
  EXPECT_EQ(before.time, 0);
  // As a reset leaves it: the numbers of the engine that are next to those of the home pose.
  const RobotState home = env.world().home_state();
  EXPECT_LE((before.p_WB - home.p_WB).lpNorm<Eigen::Infinity>(), 4 * eps());
  EXPECT_LE((before.q_WB.coeffs() - home.q_WB.coeffs()).lpNorm<Eigen::Infinity>(), 4 * eps());
  EXPECT_LE((before.q - home.q).lpNorm<Eigen::Infinity>(), 4 * eps());
  EXPECT_EQ(before.qd, home.qd);
  EXPECT_EQ(before.v_WB, home.v_WB);
  EXPECT_EQ(before.w_WB, home.w_WB);
  EXPECT_THROW(env.step(zeros(env), seen), ConfigError);
  EXPECT_THROW((void)env.save(), ConfigError);
  EnvConfig randomised;
  randomised.randomisation[Randomised::kFriction] = {0.5, 0.6};
  const QuadrupedEnv worldless = make_env(randomised);
  EXPECT_THROW((void)worldless.world(), ConfigError);
  EXPECT_THROW((void)worldless.summary(), ConfigError);
  EXPECT_TRUE(scenes::identical(env.world().state(), before));
  env.reset(0, seen);
  EXPECT_DOUBLE_EQ(env.world().state().time, env.config().settle_seconds);
  EXPECT_NO_THROW(env.step(zeros(env), seen));
}

TEST_P(Environment, ConfigurationErrorsSurface) {
  EnvConfig config;
  config.robot = "centipede";
  EXPECT_THROW(make_env(config), ConfigError);
  config = {};
  config.terrain = "moon";
  EXPECT_THROW(make_env(config), ConfigError);
  config = {};
  config.adapt = {"step_length", "girth"};
  EXPECT_THROW(make_env(config), ConfigError);
}

TEST_P(Environment, KeepsWhatBeginsOutsideItsRange) {
  EnvConfig config;
  config.gait = "pace";
  config.parameters["cycle_time"] = 0.1;  // its cycle time is below the range that adapts
  auto env = make_env(config);
  std::vector<double> seen(env.observation_size());
  env.reset(0, seen);
  for (int i = 0; i < 10; ++i) env.step(zeros(env), seen);
  EXPECT_EQ(env.info().parameters->cycle_time, config.parameters["cycle_time"]);
  const auto& entries = env.interface().observation.entries;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_GE(seen[i], entries[i].min) << entries[i].name;
    EXPECT_LE(seen[i], entries[i].max) << entries[i].name;
  }
}

TEST_P(Environment, IsChangedBetweenStepsAndContinuesFromWhatWasSaved) {
  QuadrupedEnv env = make_env({});
  std::vector<double> seen(env.observation_size()), expected = seen;
  EXPECT_THROW(env.set_state({}), ConfigError);
  env.reset(0, seen);
  const std::vector<double> first = seen;
  env.observe_start(seen);
  EXPECT_EQ(seen, first);  // nothing was set
  for (int i = 0; i < 5; ++i) env.step(zeros(env), seen);
  const auto saved = env.save();
  for (int i = 0; i < 5; ++i) env.step(zeros(env), expected);

  env.restore(*saved);
  const double distance = env.info().distance;
  RobotState lifted = env.world().state();
  lifted.p_WB += Vector3(3, -1, 0.1);
  lifted.q_WB = from_roll_pitch_yaw(0, 0, 1) * lifted.q_WB;
  env.set_state(lifted);
  EXPECT_NEAR(env.info().distance, distance, 1e-9);  // neither way nor turn is made: rounding of metres
  EXPECT_LT(std::abs(env.info().roll_pitch_yaw.z()), 0.1);
  EXPECT_EQ(env.world().state().time, saved->physics.state.time);
  env.apply_wrench({0, {{0, 0, 1}}});
  env.set_changes({parse_quantity_change("mass=x1.5", "test")});
  env.step(zeros(env), seen);
  EXPECT_EQ(env.world().save().wrenches.size(), 0U);  // of one step

  env.restore(*saved);
  EXPECT_TRUE(env.changes().empty());
  for (int i = 0; i < 5; ++i) env.step(zeros(env), seen);
  EXPECT_EQ(seen, expected);

  env.set_changes({parse_quantity_change("mass=x1", "test")});  // the same world, built anew
  env.restore(*saved);
  for (int i = 0; i < 5; ++i) env.step(zeros(env), seen);
  EXPECT_EQ(seen, expected);
  EXPECT_THROW(env.set_changes({parse_quantity_change("physics_dt=0.0005", "test")}), ConfigError);
  EXPECT_THROW(env.observe_start(seen), ConfigError);
  env.end_episode(true);
  EXPECT_THROW(env.apply_wrench({}), ConfigError);
  EXPECT_TRUE(env.step(zeros(env), seen).terminated);
}

TEST(FootTimes, CountSwingsAndStances) {
  LegArray<FootContact> contacts{};
  FootTimes times;
  times.begin(contacts);
  times.add(contacts, 0.25);
  contacts[Leg::FL].touching = true;
  times.add(contacts, 0.25);
  EXPECT_TRUE(times.landed[Leg::FL]);
  EXPECT_FALSE(times.landed[Leg::RR]);
  EXPECT_EQ(times.last_air[Leg::FL], 0.5);
  EXPECT_EQ(times.contact[Leg::FL], 0.25);
  EXPECT_EQ(times.air[Leg::RR], 0.5);
  times.add(contacts, 0.25);
  EXPECT_FALSE(times.landed[Leg::FL]);
  contacts[Leg::FL].touching = false;
  times.add(contacts, 0.25);
  EXPECT_TRUE(times.lifted[Leg::FL]);
  EXPECT_EQ(times.last_contact[Leg::FL], 0.75);
  EXPECT_EQ(times.air[Leg::FL], 0.25);
}

}  // namespace
}  // namespace crossgait
