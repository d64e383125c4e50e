// How well policies do what they are asked, each in each engine: a cell of a table for every two of them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "diagnosis/walk_score.h"
#include <nlohmann/json_fwd.hpp>

#include "physics/core/progress.h"

namespace crossgait {

/// Holds a policy with the environment that it is asked in.
struct ScoredPolicy {
  std::string name;
  std::string trained_in;  ///< an engine's name, or "" where nobody says
  LoadedEnv environment;
  RelabelledPolicy policy;
};

/// Says how policies are scored.
struct PolicyScoreOptions {
  std::size_t starts = 6;  ///< of every command, 2 or more
  double seconds = 6;      ///< of a walk, whose first second does not count
  std::uint64_t seed = 0;
  std::size_t workers = 1;
};

/// Holds what came of one policy in one engine. Means are over commands and starts; the interval of `value`
/// is the 95 % one of the mean over starts (Student's), that of falls Clopper and Pearson's.
struct PolicyCell {
  std::string policy, trained_in, engine;
  double value = 0, low = 0, high = 0;  ///< walk_score: 0 is best, 4 worst
  std::size_t walks = 0, falls = 0;
  double falls_low = 0, falls_high = 0;        ///< of the share
  double speed_error = 0, yaw_rate_error = 0;  ///< m/s, rad/s
  double jitter = 0;                           ///< rad/s^2
  double effort = 0;                           ///< power over weight and speed
  std::vector<double> by_start;                ///< the score, mean over commands
  bool done = false;                           ///< does_what_is_asked
  std::string complaint;                       ///< what_is_wrong
};

/// Walks every policy in every engine, straight ahead, turning and standing. The same for any number of
/// workers.
/// @returns cells, policy by policy
/// @throws ConfigError for a configuration that an engine cannot have; Interrupted from `progress`
std::vector<PolicyCell> score_policies(std::span<const ScoredPolicy> policies,
                                       std::span<const std::string> engines,
                                       const PolicyScoreOptions& options, const Progress& progress = {});

/// Returns a sentence for each policy, a line each: in how many engines it does what it is asked.
std::string summary_of(std::span<const PolicyCell> cells);
/// Describes cells as a table, below a sentence for each policy.
std::string describe(std::span<const PolicyCell> cells);
/// Returns what `crossgait score --json` writes.
nlohmann::ordered_json to_json(std::span<const PolicyCell> cells, const PolicyScoreOptions& options);

}  // namespace crossgait
