// A run of a walk and one of a policy, both short.
#pragma once

#include <variant>

#include "study/run_spec.h"

namespace crossgait {

inline RunSpec walk_run() {
  WalkConfig config;
  config.terrain = "rough:size_x=2,size_y=2";
  config.timing = {.seconds = 0.3, .settle_seconds = 0.1};
  return {{config, {}, 3}, "mujoco", "2.2.2", {}, 1};
}

inline RunSpec policy_run() {
  PolicyConfig config;
  config.environment.episode_seconds = 0.3;
  config.environment.settle_seconds = 0.1;
  return {{config, {}, 3}, "mujoco", "2.2.2", {}, 1};
}

inline WalkConfig& walk_of(RunSpec& run) { return std::get<WalkConfig>(run.behaviour.what); }
inline PolicyConfig& policy_of(RunSpec& run) { return std::get<PolicyConfig>(run.behaviour.what); }

}  // namespace crossgait
