// Policies that know nothing, for long: no crash, no NaN, no runaway, whatever they do.
#include "env/vector_env.h"
#include "tests/support/engine_test.h"
#include "tests/support/environments.h"

namespace crossgait {
namespace {

class RandomActions : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(RandomActions);

// A part of the 10^6 steps per engine and terrain of docs/environment-measured.md, which take minutes.
TEST_P(RandomActions, LeaveEverythingFinite) {
  for (const char* terrain : {"flat", "rough"}) {
    EnvConfig config;
    config.terrain = terrain;
    config.episode_seconds = 4;
    config.residual_scale = 0.03;  // three times what is sensible: legs at their limits all the time
    config.observation.emplace_back("terrain");
    config.reward.fill(1);
    VectorEnv env(config, find_engine(GetParam()), {.environments = 2, .workers = 2});
    std::vector<double> seen(env.size() * env.observation_size()), rewards(env.size());
    std::vector<std::uint8_t> terminated(env.size()), truncated(env.size());
    env.reset(1, seen);
    Random random(2);
    for (int i = 0; i < 5000; ++i) {
      env.step(scenes::random_action(random, env.size() * env.action_size()),
               {seen, rewards, terminated, truncated});
      for (const double x : seen) ASSERT_TRUE(std::isfinite(x)) << "step " << i;
      for (const double r : rewards) ASSERT_TRUE(std::isfinite(r)) << "step " << i;
    }
    EXPECT_EQ(env.diverged(), 0U);
  }
}

}  // namespace
}  // namespace crossgait
