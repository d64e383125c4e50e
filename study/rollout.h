// Policies over whole episodes in one engine, and one policy over engines and grounds.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "env/evaluation.h"
#include "motion/trace.h"
#include "physics/core/table.h"

namespace crossgait {

/// Says how many episodes, from which seed, on how many threads.
struct EpisodeOptions {
  std::size_t episodes = 3, workers = default_workers();
  std::uint64_t seed = 0;

  /// Returns as many threads as the machine has.
  static std::size_t default_workers();
};

/// Holds one policy's episodes.
struct PolicyEpisodes {
  std::string policy;
  std::vector<EpisodeSummary> episodes;
  Evaluation all;
};

struct Rollout {
  EnvConfig config;
  std::uint64_t seed = 0;
  std::vector<PolicyEpisodes> policies;
  bool interrupted = false;  ///< before its end, by a Progress that threw Interrupted
};

/// Names a policy as tables do, and makes it.
struct NamedPolicy {
  std::string name;
  PolicyFactory make;
};
/// Reads a policy as `load_policy` does. @throws ConfigError
NamedPolicy find_policy(const std::string& text);

/// Runs every policy on the same worlds. An interruption leaves the episodes that are finished. @throws
/// ConfigError
Rollout roll_out(const LoadedEnv& environment, std::span<const NamedPolicy> policies,
                 const EpisodeOptions& options, const Progress& progress = {});
Rollout roll_out(const LoadedEnv& environment, const std::vector<std::string>& policies,
                 const EpisodeOptions& options, const Progress& progress = {});

/// Runs an episode of a policy once more, by default the first. @param observer  sees the environment after
/// every policy step  @param episode  its number among those of `seed`
EpisodeSummary watch_episode(const LoadedEnv& environment, const NamedPolicy& policy, std::uint64_t seed,
                             const std::function<void(const QuadrupedEnv&)>& observer,
                             std::size_t episode = 0);
/// Records the same episode as a trace: `sink` takes what it is after every policy step.
void record_episode(const LoadedEnv& environment, const NamedPolicy& policy, std::uint64_t seed,
                    TraceSink& sink);
inline void record_episode(const LoadedEnv& environment, const std::string& policy, std::uint64_t seed,
                           TraceSink& sink) {
  record_episode(environment, find_policy(policy), seed, sink);
}

/// Compares one policy with none, in one engine on one ground.
struct TransferCell {
  std::string terrain, engine;
  Evaluation policy, baseline;
};

struct Transfer {
  std::string policy;
  std::uint64_t seed = 0;
  std::vector<std::string> engines, terrains;
  std::vector<TransferCell> cells;  ///< terrain by terrain, engine by engine
  bool interrupted = false;         ///< before its end, by a Progress that threw Interrupted
};

/// Compares a policy with none; interrupted, it leaves the cells that are finished. @throws ConfigError
Transfer transfer_policy(const LoadedEnv& environment, const NamedPolicy& policy,
                         const std::vector<std::string>& engines, const std::vector<std::string>& terrains,
                         const EpisodeOptions& options, const Progress& progress = {});
inline Transfer transfer_policy(const LoadedEnv& environment, const std::string& policy,
                                const std::vector<std::string>& engines,
                                const std::vector<std::string>& terrains, const EpisodeOptions& options,
                                const Progress& progress = {}) {
  return transfer_policy(environment, find_policy(policy), engines, terrains, options, progress);
}

/// Makes environments of one configuration, which share its model, in the engine that it names.
/// @throws ConfigError
EnvFactory env_factory(const LoadedEnv& environment);

/// Says how fast every policy went, and how its episodes ended.
std::string summary(const Rollout& rollout);
/// Says what is doubtful of it: many actions of a policy that were clipped.
std::vector<std::string> notes_on(const Rollout& rollout);
/// Writes keys as in docs/schemas.
nlohmann::ordered_json to_json(const ClippedActions& actions);
nlohmann::ordered_json to_json(const Evaluation& evaluation);
nlohmann::ordered_json to_json(const EpisodeSummary& episode);
nlohmann::ordered_json to_json(const Rollout& rollout);
nlohmann::ordered_json to_json(const Transfer& transfer);
Table table(const Rollout& rollout);
Table table(const Transfer& transfer);
std::string describe(const Rollout& rollout);
std::string describe(const Transfer& transfer);
/// Returns a policy's name in a table: a file's without its folder.
std::string short_name(const std::string& policy);

/// Says "3 fell, 1 left the terrain", "all walked".
std::string outcomes_in_words(const Evaluation& evaluation);

}  // namespace crossgait
