// Steps sixty-four robots on two threads, under noise of the ground's friction.
#include <cstdio>
#include <random>
#include <vector>

#include "crossgait/backends/registry.h"
#include "crossgait/env/vector_env.h"

int main() {
  crossgait::EnvConfig config;
  config.terrain = "rough";
  config.policy_dt = 0.02;
  config.episode_seconds = 1;
  config.randomisation[crossgait::Randomised::kFriction] = {0.4, 0.8};
  crossgait::VectorEnv envs(config, crossgait::find_engine(crossgait::available_engines().front()),
                            {.environments = 64, .workers = 2});
  std::vector<double> observations(envs.size() * envs.observation_size()), rewards(envs.size());
  std::vector<std::uint8_t> terminated(envs.size()), truncated(envs.size());
  std::vector<double> actions(envs.size() * envs.action_size());
  std::mt19937 random(0);
  std::normal_distribution<double> normal(0, 0.1);
  envs.reset(1, observations);
  for (int i = 0; i < 50; ++i) {
    for (double& action : actions) action = normal(random);
    envs.step(actions, {observations, rewards, terminated, truncated});
  }
  double way = 0;  // m, of the episodes that have just come to their end
  for (std::size_t i = 0; i < envs.size(); ++i) way += envs.environment(i).info().distance;
  std::printf("%zu robots: %.3f m on average\n", envs.size(), way / static_cast<double>(envs.size()));
}
