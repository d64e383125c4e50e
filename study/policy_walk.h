// A policy's episode, as a walk is looked at: in one engine, or in several side by side.
#pragma once

#include <string>
#include <vector>

#include "parity/comparison.h"
#include "study/rollout.h"

namespace crossgait {

/// Runs the first episode of a policy in every engine, from the same start, compared after every policy step
/// over the time that both of a pair go on. An interruption leaves the engines whose episode is finished.
/// @param policy      read, or of whoever calls
/// @param seed        of the episode, as `roll_out` has it
/// @param tolerances  as `compare_engines`
/// @param sinks       of all engines, or none: take every policy step
/// @throws ConfigError for no engine, one twice, or a policy for another environment
Comparison compare_episodes(const LoadedEnv& environment, const NamedPolicy& policy,
                            const std::vector<std::string>& engines, std::uint64_t seed,
                            const DivergenceTolerances& tolerances = {}, const Progress& progress = {},
                            const TraceSinks& sinks = {});
inline Comparison compare_episodes(const LoadedEnv& environment, const std::string& policy,
                                   const std::vector<std::string>& engines, std::uint64_t seed,
                                   const DivergenceTolerances& tolerances = {}, const Progress& progress = {},
                                   const TraceSinks& sinks = {}) {
  return compare_episodes(environment, find_policy(policy), engines, seed, tolerances, progress, sinks);
}

}  // namespace crossgait
