// Steps a reinforcement-learning environment with a policy that does nothing: an episode of the gait alone.
#include <cstdio>
#include <vector>

#include "crossgait/backends/registry.h"
#include "crossgait/env/quadruped_env.h"

int main() {
  crossgait::EnvConfig config;
  config.terrain = "rough";
  config.policy_dt = 0.02;
  config.episode_seconds = 2;
  crossgait::QuadrupedEnv env(config, crossgait::find_engine(crossgait::available_engines().front()));
  std::vector<double> observation(env.observation_size()), action(env.action_size());
  env.reset(7, observation);
  crossgait::StepResult step;
  double total = 0;
  while (!step.terminated && !step.truncated) {
    step = env.step(action, observation);
    total += step.reward;
  }
  std::printf("%.3f m, return %.3f\n", env.info().distance, total);
}
