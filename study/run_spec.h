// One run, said completely: what moves, in which engine, under which variation, from which start. Written as
// canonical JSON it has a hash, by which a result is found again.
#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "parity/behaviour.h"
#include "physics/core/files_read.h"
#include "physics/engine/engine.h"
#include "study/loaded_walk.h"
#include "study/rollout.h"
#include "study/version.h"

namespace crossgait {

/// Names a policy in its environment.
struct PolicyConfig {
  EnvConfig environment;        ///< its engine is the run's
  std::string policy = "zero";  ///< as `load_policy` takes it
};

/// Says what a verdict, a sweep or a single run is about, in whatever engine.
struct BehaviourSpec {
  std::variant<WalkConfig, PolicyConfig> what;
  StartRanges starts;
  std::uint64_t seed = 0;  ///< of the starts
};

/// Holds a policy in its environment, whose files are read.
struct LoadedPolicy {
  /// @param name  of the policy, as `load_policy` takes it. @throws ConfigError
  LoadedPolicy(const LoadedEnv& environment, const std::string& name);

  std::shared_ptr<const EnvModel> model;
  NamedPolicy policy;
  std::vector<FileRead> files;  ///< that the policy was made of: its own, and those that it names
};

/// Holds a behaviour, robot and ground read once: whoever describes, judges and runs it means the same one.
struct LoadedBehaviour {
  std::variant<LoadedWalk, LoadedPolicy> what;
  StartRanges starts;
  std::uint64_t seed = 0;
  nlohmann::json described;  ///< as it stands in a run: `behaviour`, `starts` and `seed`

  /// Converts: a specification may stand wherever one that is read is asked for. @throws ConfigError
  LoadedBehaviour(const BehaviourSpec& spec);
  LoadedBehaviour(LoadedWalk walk, const StartRanges& ranges, std::uint64_t of_starts);
  LoadedBehaviour(const PolicyConfig& policy, const StartRanges& ranges, std::uint64_t of_starts);
  LoadedBehaviour(const LoadedEnv& environment, const std::string& policy, const StartRanges& ranges,
                  std::uint64_t of_starts);

  /// Returns the world that it takes place in: a walk's, or its environment's.
  const WorldSpec& world() const;
};

/// Describes one run of a behaviour.
struct RunSpec {
  BehaviourSpec behaviour;
  std::string engine, engine_version;  ///< EngineInfo::name and EngineInfo::version
  Variation variation;
  std::size_t start = 0;
  double horizon = kToTheEnd;  ///< s of motion, at most
  std::string crossgait = std::string(crossgait_version());
};

/// Says what came of a run, by the keys of the behaviour's statistics.
struct RunResult {
  std::vector<std::string> keys;
  BehaviourRun run;
};

/// Writes everything that the result of a run depends on, and nothing else: keys sorted, no spaces, numbers
/// with as many digits as bring them back. Files of policies and terrains stand with the SHA-256 of their
/// bytes. `schema` is run/4.
nlohmann::json to_json(const RunSpec& spec);
/// Describes one run of a behaviour that is described already. @param behaviour  LoadedBehaviour::described
nlohmann::json describe_run(nlohmann::json behaviour, const EngineInfo& engine, const Variation& variation,
                            std::size_t start, double horizon = kToTheEnd);
std::string canonical_json(const RunSpec& run);
/// Returns the 64-bit FNV-1a of the canonical JSON, as 16 hexadecimal digits.
std::string run_hash(const RunSpec& run);

/// Returns the robot's name and `identity_hash`.
nlohmann::json identity_of_robot(const RobotDescription& robot);

/// Makes what is judged and run. @throws ConfigError for what cannot be made
Behaviour make_behaviour(const LoadedBehaviour& loaded);

/// Makes a behaviour of any walk: on the ground of `walk`, whose random terrains differ by start.
Behaviour make_behaviour(const LoadedWalk& walk, const WalkSetup& setup, const StartRanges& starts,
                         std::uint64_t seed);

/// Makes one run of a behaviour. @throws ConfigError
RunResult run(const Behaviour& behaviour, const Engine& engine, const Variation& variation, std::size_t start,
              double horizon = kToTheEnd);
/// Makes the run. @throws ConfigError, also where Crossgait or the engine is of another version
RunResult run(const RunSpec& spec);

}  // namespace crossgait
