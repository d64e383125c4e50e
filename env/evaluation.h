// How well a policy does: whole episodes, summed up.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "env/clipped_actions.h"
#include "env/quadruped_env.h"
#include "motion/motion_averages.h"
#include "physics/core/progress.h"

namespace crossgait {

/// Holds what a reward term of the user's own (EnvExtension) comes to.
struct OwnRewardTerm {
  std::string name;
  double sum = 0;  ///< weighted, of one episode; of several the mean
};

/// Sums up one episode.
struct EpisodeSummary {
  std::uint64_t seed = 0;
  MotionSummary motion;
  double total_reward = 0;
  RewardTerms reward_terms{};  ///< sums, weighted
  std::vector<OwnRewardTerm> own_reward_terms;
  std::int64_t steps = 0, invalid_actions = 0;
  ClippedActions clipped_actions;
  std::optional<GaitParameters> parameters;  ///< at the end, where actions adapt a gait
};

/// Called after every step; false ends the episode.
using EpisodeObserver = std::function<bool(const QuadrupedEnv& env)>;

/// Runs one episode from reset(seed) to its end, or until the policy has failed. The policy must be for
/// `env.interface()`.
/// @throws ConfigError if it is not
EpisodeSummary run_episode(QuadrupedEnv& env, Policy& policy, std::uint64_t seed,
                           const EpisodeObserver& observer = {});

/// Makes what one worker needs. Called once per worker, on the caller's thread.
using EnvFactory = std::function<std::unique_ptr<QuadrupedEnv>()>;

/// Runs episode k with derived_seed(seed, k) for environment and policy, so that two policies meet the same
/// worlds; results are in that order and the same for any number of workers. If `progress` throws
/// Interrupted, the episodes that are finished are returned.
std::vector<EpisodeSummary> evaluate_policy(const EnvFactory& make_env, const PolicyFactory& make_policy,
                                            std::size_t episodes, std::uint64_t seed, std::size_t workers = 1,
                                            const Progress& progress = {});

/// Holds what a set of episodes comes to.
struct Evaluation {
  std::size_t episodes = 0;
  MeanAndDeviation total_reward;
  MotionAverages motion;
  RewardTerms reward_terms{};  ///< means of the sums
  std::vector<OwnRewardTerm> own_reward_terms;
  double simulated_seconds = 0;                 ///< sum
  std::int64_t steps = 0, invalid_actions = 0;  ///< sums
  ClippedActions clipped_actions;
  std::array<std::size_t, kOutcomes> outcomes{};  ///< episodes of each outcome

  std::size_t count(Outcome outcome) const noexcept { return outcomes[static_cast<std::size_t>(outcome)]; }
  /// Averages the mean speeds of the episodes, m/s.
  double mean_speed() const { return motion.of(&MotionSummary::mean_speed_mps).mean; }
  /// Counts episodes that an outcome of `EnvConfig::terminations` cut short, or would by default, or a
  /// termination of the user's own.
  std::size_t ended_early() const noexcept;
};
Evaluation sum_up(const std::vector<EpisodeSummary>& episodes);

}  // namespace crossgait
