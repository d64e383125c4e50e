// How well a policy does: whole episodes, summed up.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "crossgait/env/adaptive_gait_env.h"

namespace crossgait {

/// One episode. Speeds are per simulated second.
struct EpisodeSummary {
  std::uint64_t seed = 0;
  double total_reward = 0;
  RewardTerms reward_terms{};            ///< sums, weighted
  double simulated_seconds = 0;          ///< s
  double distance_m = 0, lateral_m = 0;  ///< along and left of the heading at the start
  double mean_speed_mps = 0;             ///< distance over simulated time
  double rms_roll_deg = 0, rms_pitch_deg = 0;
  double slip_m = 0;             ///< path length that loaded feet slid, all four together
  double cost_of_transport = 0;  ///< of the servo joints, over weight times path; 0 if it did not move
  std::int64_t steps = 0, ik_clamped = 0, invalid_actions = 0;
  bool fell = false, left_terrain = false, diverged = false;
  GaitParameters parameters;  ///< at the end
};

/// Called after every step; false ends the episode.
using EpisodeObserver = std::function<bool(const AdaptiveGaitEnv& env)>;

/// Runs one episode from reset(seed) to its end. The policy must be for `env.interface()`.
/// @throws ConfigError if it is not
EpisodeSummary run_episode(AdaptiveGaitEnv& env, Policy& policy, std::uint64_t seed,
                           const EpisodeObserver& observer = {});

/// Makes what one worker needs. Called once per worker, on the caller's thread.
using EnvFactory = std::function<std::unique_ptr<AdaptiveGaitEnv>()>;
using PolicyFactory = std::function<std::unique_ptr<Policy>(const PolicyInterface&)>;

/// Episode k runs with derived_seed(seed, k) for environment and policy, so that two policies meet the same
/// worlds; results are in that order and the same for any number of workers.
/// @param progress  called now and then with the share of episodes done, from any worker, one at a time
std::vector<EpisodeSummary> evaluate_policy(const EnvFactory& make_env, const PolicyFactory& make_policy,
                                            std::size_t episodes, std::uint64_t seed, std::size_t workers = 1,
                                            const std::function<void(double)>& progress = {});

/// What a set of episodes comes to.
struct Evaluation {
  struct Spread {
    double mean = 0, deviation = 0;  ///< deviation: of the sample, zero for a single episode
  };
  std::size_t episodes = 0;
  Spread total_reward, speed, distance;
  RewardTerms reward_terms{};                                                     ///< means of the sums
  double rms_roll_deg = 0, rms_pitch_deg = 0, slip_m = 0, cost_of_transport = 0;  ///< means
  double simulated_seconds = 0;                                                   ///< sum
  std::int64_t steps = 0, ik_clamped = 0, invalid_actions = 0;                    ///< sums
  std::size_t falls = 0, diverged = 0, left_terrain = 0;                          ///< episodes
};
Evaluation sum_up(const std::vector<EpisodeSummary>& episodes);

}  // namespace crossgait
