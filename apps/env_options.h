// Options that `env`, `rollout`, `transfer` and `tune` share: the environment's configuration.
#pragma once

#include <optional>

#include "apps/command.h"
#include "apps/contact_option.h"
#include "study/rollout.h"

namespace crossgait::apps {

/// Adds `--workers` alone.
void add_workers_option(CLI::App& command, std::size_t& workers);

/// Says what options may set of an environment.
enum class EnvScope {
  kAll,
  kManyWorlds,   ///< all but --engine and --terrain: where a command takes lists of them
  kMethodAlone,  ///< what moves the robot: where a course says everything else
};

/// Holds a configuration file and what is given on top of it.
struct EnvOptions {
  std::string config;
  std::optional<std::string> engine, robot, terrain, gait;
  std::optional<std::uint64_t> terrain_seed;
  std::vector<std::string> settings;  // NAME=VALUE of gait parameters and of keys
  std::vector<std::string> adapt, observe;
  std::string velocity;
  ContactOptions contact;
  std::optional<double> residual_scale, policy_dt, episode_seconds;

  void add_to(CLI::App& command, EnvScope scope = EnvScope::kAll);
  /// @param policy  without --config, the environment of a policy that comes with Crossgait is where one
  /// begins
  /// The robot is read, for everything that the command does with it. @throws ConfigError
  LoadedEnv make(const std::string& policy = {}) const;

 private:
  void require_gait(const EnvConfig& c) const;
};

/// Applies `--set NAME=VALUE`: parameters of the gait, and keys of an environment with values in YAML.
/// @throws ConfigError
void apply_settings(const std::vector<std::string>& settings, EnvConfig& config);

/// Reads the robot of a configuration, with its warnings. @throws ConfigError
LoadedEnv load_with_warnings(const EnvConfig& config);

/// Reads the environment in which a policy is judged: --env, or that of its folder. @param env  as given, or
/// ""
/// @throws ConfigError where there is neither, or none that can be read
EnvConfig environment_of(const std::string& env, const std::string& policy);

/// Describes what policies are looked at in, for their provenance. @param seed  of the episodes
nlohmann::json policy_subject(const LoadedEnv& environment, const std::vector<std::string>& policies,
                              std::uint64_t seed);

/// Adds `--episodes`, `--seed`, `--workers`.
void add_episode_options(CLI::App& command, EpisodeOptions& options);

}  // namespace crossgait::apps
