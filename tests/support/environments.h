// Environments for tests: any engine, random actions, everything bit for bit.
#pragma once

#include <string>
#include <vector>

#include "backends/registry.h"
#include "env/quadruped_env.h"
#include "physics/core/random.h"

namespace crossgait::scenes {

inline std::vector<double> random_action(Random& random, std::size_t size) {
  std::vector<double> action(size);
  for (double& a : action) a = random.uniform(-1, 1);
  return action;
}

/// Adds a block, with what it shows where that is a setting: a clock, points of the ground, constants.
inline void observe(EnvConfig& config, std::string_view block) {
  config.observation.emplace_back(std::string(block));
  ObservationSettings& settings = config.observing;
  if (block.starts_with("clock")) {
    settings.clock.frequency = 2;
    settings.clock.phases = {0, 0.5};
  }
  if (block == "height_scan") {
    settings.height_scan.x = {-0.1, 0, 0.1};
    settings.height_scan.y = {-0.05, 0.05};
  }
  if (block == "constants") settings.constants = {0.25, -1};
}

/// Tells whether a block shows what an environment has anyway, and no setting.
inline bool needs_no_setting(const ObservationBlock& block) {
  EnvConfig config;
  observe(config, block.name);
  return config.observing == ObservationSettings();
}

/// Records observations and rewards of `steps` steps under random actions, episode after episode.
inline std::vector<double> record(QuadrupedEnv& env, Random& random, int steps) {
  std::vector<double> all, observation(env.observation_size());
  for (int i = 0; i < steps; ++i) {
    const StepResult result = env.step(random_action(random, env.action_size()), observation);
    all.insert(all.end(), observation.begin(), observation.end());
    all.push_back(result.reward);
    if (result.done()) env.reset(static_cast<std::uint64_t>(random.uniform(0, 1e9)), observation);
  }
  return all;
}

}  // namespace crossgait::scenes
