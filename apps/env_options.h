// Options that `env`, `rollout`, `transfer` and `tune` share: the environment's configuration.
#pragma once

#include <optional>

#include "crossgait/apps/command.h"
#include "crossgait/env/evaluation.h"

namespace crossgait::apps {

/// Threads for episodes: as many as the machine has.
std::size_t default_workers();
/// `--workers`. Adds the option alone.
void add_workers_option(CLI::App& command, std::size_t& workers);

/// A configuration file and what is given on top of it.
struct EnvOptions {
  std::string config;
  std::optional<std::string> backend, robot, terrain, gait;
  std::optional<std::uint64_t> terrain_seed;
  std::vector<std::string> settings;  // NAME=VALUE of gait parameters
  std::vector<std::string> adapt, observe;
  std::string velocity;
  std::optional<double> friction, residual_scale, policy_dt, episode_seconds;

  /// @param world  with --engine and --terrain; without, where a command takes lists of them
  void add_to(CLI::App& command, bool world = true);
  /// @throws ConfigError
  EnvConfig make() const;
};

/// How many episodes, from which seed, on how many threads.
struct EpisodeOptions {
  std::size_t episodes = 3, workers = default_workers();
  std::uint64_t seed = 0;

  void add_to(CLI::App& command);
};

/// The engine that the configuration names. @throws ConfigError if it is not built in
EnvFactory env_factory(const EnvConfig& config);
PolicyFactory policy_factory(const std::string& policy);
/// A policy's name in a table: a file's without its folder.
std::string short_name(const std::string& policy);

/// Every statistic of an evaluation, reward terms with a weight by name.
nlohmann::ordered_json to_json(const Evaluation& evaluation);
nlohmann::ordered_json to_json(const EpisodeSummary& episode);
/// "3 fell, 1 left the ground", "all walked".
std::string outcome(const Evaluation& evaluation);

}  // namespace crossgait::apps
