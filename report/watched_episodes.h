// What the pages of environments replay: episodes of policies, with what each step earned.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "env/loaded_env.h"
#include "report/motion_document.h"
#include "study/rollout.h"

namespace crossgait {

/// Holds one run of a page.
struct WatchedEpisode {
  std::string name;  ///< what the page calls it
  LoadedEnv environment;
  NamedPolicy policy;
  std::size_t number = 0;  ///< among the episodes of the seed
};

/// Runs each again, to its end. All are on the ground of the first one.
/// @param sample_time  least time between two samples, s, where every policy step is more than a page needs:
///                     rewards are those of the steps that are sampled
/// @throws ConfigError as `watch_episode` does
Motion watch_episodes(const std::vector<WatchedEpisode>& episodes, std::uint64_t seed,
                      double sample_time = 0);

}  // namespace crossgait
