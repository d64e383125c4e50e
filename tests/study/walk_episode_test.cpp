// A walk and an episode of the zero policy are the same motion: one loop, one set of numbers.
#include <nlohmann/json.hpp>

#include "parity/report.h"
#include "physics/core/error.h"
#include "study/rollout.h"
#include "study/walk.h"
#include "tests/physics/core/config_error.h"
#include "tests/support/engine_test.h"
#include "tests/support/motion_bits.h"

namespace crossgait {
namespace {

WalkConfig short_walk(const std::string& gait, const std::optional<VelocityCommand>& command = {}) {
  WalkConfig config;
  config.gait = choose_gait(gait, {}, command);
  config.timing = {.seconds = 1.5, .settle_seconds = 0.3};
  return config;
}

std::vector<WalkConfig> walks() {
  std::vector<WalkConfig> all{short_walk("trot"), short_walk("walk"),
                              short_walk("trot", VelocityCommand{0.1, 0.03, 0.3})};
  WalkConfig rough = short_walk("trot");
  rough.terrain = "rough:size_x=4,size_y=4";
  rough.terrain_seed = 3;
  rough.contact.add(friction_of(0.9));
  rough.physics_dt = 0.5e-3;
  all.push_back(rough);
  WalkConfig bound = short_walk("bound");
  bound.robot = "scara_quadruped_long";
  bound.timing.control_dt = 4e-3;
  all.push_back(bound);
  WalkConfig leaving = short_walk("gallop");
  leaving.terrain = "slope:angle=0,size_x=.3,size_y=1";
  all.push_back(leaving);
  return all;
}

class WalkAndEpisode : public EngineTest {
 protected:
  static EnvConfig environment_of(const WalkConfig& config) {
    EnvConfig environment = config.environment();
    environment.engine = GetParam();
    environment.terminations = OutcomeSet::of_walks();
    environment.adapt = {"step_length"};  // a cycle time may be shorter than those that adapt
    return environment;
  }
  static MotionSummary walk(const WalkConfig& config, TraceSink* sink = nullptr) {
    const auto world = find_engine(GetParam()).make(LoadedWalk(config).world);
    return record_walk(*world, config.setup(), {}, sink).summary;
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(WalkAndEpisode);

TEST_P(WalkAndEpisode, HaveTheSameNumbersToTheLastBit) {
  for (const WalkConfig& config : walks()) {
    SCOPED_TRACE(config.gait.name() + " of " + config.robot + " on " + config.terrain);
    const MotionSummary walked = walk(config);
    const auto env = env_factory(environment_of(config))();
    const auto zero = find_policy("zero").make(env->interface());
    const EpisodeSummary episode = run_episode(*env, *zero, 5);
    EXPECT_EQ(differences(walked, episode.motion), "");
    EXPECT_EQ(to_json(walked), to_json(episode.motion));
    EXPECT_GT(walked.path_m, 0.02);
    EXPECT_TRUE(walked.swing_contact_ratio.has_value());
  }
}

TEST_P(WalkAndEpisode, LeaveTheSameTrace) {
  for (const WalkConfig& config : walks()) {
    SCOPED_TRACE(config.gait.name() + " of " + config.robot + " on " + config.terrain);
    TraceRecorder walking, policy;
    walk(config, &walking);
    record_episode(environment_of(config), "zero", 5, policy);
    const Trace &walked = walking.samples(), &episode = policy.samples();
    ASSERT_EQ(walked.size(), episode.size());
    const auto whole = static_cast<std::size_t>(config.timing.control_steps());
    // One is over the edge of its small field before its time, and ends there.
    if (config.terrain.find("size_x=.3") != std::string::npos) {
      EXPECT_LT(walked.size(), whole);
    } else {
      EXPECT_EQ(walked.size(), whole);
    }
    for (std::size_t i = 0; i < walked.size(); ++i)
      ASSERT_TRUE(identical(walked[i], episode[i])) << "first in step " << i;
  }
}

TEST_P(WalkAndEpisode, LongerPolicyStepsChangeNothingOfThem) {
  const WalkConfig config = short_walk("trot");
  EnvConfig environment = environment_of(config);
  environment.policy_dt = 0.02;
  const auto env = env_factory(environment)();
  const auto zero = find_policy("zero").make(env->interface());
  EXPECT_EQ(differences(walk(config), run_episode(*env, *zero, 1).motion), "");
}

TEST(WalkConfig, IsNoEnvironmentWhereAnEnvironmentCannotDoIt) {
  EXPECT_THROW((void)short_walk("auto", VelocityCommand{0.1, 0, 0}).environment(), ConfigError);
  WalkConfig plain = short_walk("trot");
  plain.compensation = false;
  const ConfigError error = config_error([&] { (void)plain.environment(); });
  EXPECT_EQ(error.source(), "environment");
  EXPECT_EQ(error.element(), "compensation");
}

TEST(WalkConfig, MakesTheWorldThatItSays) {
  WalkConfig config;
  config.robot = "scara_quadruped_long";
  config.terrain = "rough:size_x=2,size_y=2";
  config.terrain_seed = 4;
  config.contact.add(friction_of(0.3));
  config.physics_dt = 5e-4;
  const WorldSpec world = LoadedWalk(config).world, other = EnvModel::make(config.environment())->world;
  for (const WorldSpec& w : {world, other}) {
    EXPECT_EQ(w.robot->name, "scara_quadruped_long");
    EXPECT_EQ(w.contact.friction, 0.3);
    EXPECT_EQ(w.physics_dt, 5e-4);
    EXPECT_EQ(w.terrain.height(0.7, 0.4), make_terrain(config.terrain, 4).height(0.7, 0.4));
  }
  EXPECT_THROW((void)friction_of(-1), ConfigError);
}

}  // namespace
}  // namespace crossgait
