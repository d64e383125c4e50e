// One run, said completely: what moves, in which engine, under which variation, from which start. Written as
// canonical JSON it has a hash, by which a result is found again.
#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "parity/behaviour.h"
#include "physics/engine/engine.h"
#include "study/version.h"
#include "study/walk_config.h"

namespace crossgait {

/// A policy in its environment.
struct PolicyConfig {
  EnvConfig environment;        ///< its engine is the run's
  std::string policy = "zero";  ///< as `make_policy` takes it
};

/// What a verdict, a sweep or a single run is about, in whatever engine.
struct BehaviourSpec {
  std::variant<WalkConfig, PolicyConfig> what;
  StartRanges starts;
  std::uint64_t seed = 0;  ///< of the starts
};

/// One run of it.
struct RunSpec {
  BehaviourSpec behaviour;
  std::string engine, engine_version;  ///< EngineInfo::name and EngineInfo::version
  Variation variation;
  std::size_t start = 0;
  std::string crossgait = std::string(crossgait_version());
};

/// The numbers of a run, by the names of the behaviour's statistics.
struct RunResult {
  std::vector<std::string> names;
  std::vector<double> values;
};

/// Everything that the result of a run depends on, and nothing else: keys sorted, no spaces, numbers with as
/// many digits as bring them back. Files of policies and terrains stand with the SHA-256 of their bytes.
/// `schema` is run/2.
nlohmann::json to_json(const RunSpec& spec);
/// The same where its behaviour is described already: `behaviour` is `to_json(spec.behaviour)`.
nlohmann::json to_json(const RunSpec& spec, nlohmann::json behaviour);
std::string canonical_json(const RunSpec& run);
/// 64-bit FNV-1a of the canonical JSON, as 16 hexadecimal digits.
std::string run_hash(const RunSpec& run);

/// What moves, as it stands in a run: `behaviour`, `starts` and `seed`.
nlohmann::json to_json(const BehaviourSpec& spec);
/// The robot by its name and `identity_hash`. @throws ConfigError
nlohmann::json identity_of_robot(const std::string& name_or_file);

/// The behaviour that a specification describes. @throws ConfigError for what cannot be read or made
Behaviour make_behaviour(const BehaviourSpec& spec);

/// The same of any walk: on the ground of `config`, whose random terrains differ from start to start.
Behaviour make_behaviour(const WalkConfig& config, const WalkSetup& setup, const StartRanges& starts,
                         std::uint64_t seed);

/// Makes the run. @throws ConfigError, also where Crossgait or the engine is of another version
RunResult run(const RunSpec& spec);

}  // namespace crossgait
