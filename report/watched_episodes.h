// What the pages of `rollout` and `transfer` replay: first episodes of policies, with what each step earned.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "env/loaded_env.h"
#include "report/motion_document.h"

namespace crossgait {

/// One run of a page.
struct WatchedEpisode {
  std::string name;  ///< what the page calls it
  LoadedEnv environment;
  std::string policy;  ///< as `load_policy` takes it
};

/// Runs the first episode of each again. All are on the ground of the first one.
/// @throws ConfigError as `watch_episode` does
Motion watch_episodes(const std::vector<WatchedEpisode>& episodes, std::uint64_t seed);

}  // namespace crossgait
