// A verdict with all that belongs to it, as one call.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "parity/attribution.h"
#include "parity/consensus.h"
#include "parity/model_audit.h"
#include "parity/verdict.h"
#include "study/run_spec.h"

namespace crossgait {

struct JudgeOptions {
  VerdictOptions verdict;
  bool explain = false;     ///< also say what the gap comes from
  std::string stored_runs;  ///< file of runs to take and to add to (RunStore); empty: none
};

struct PairVerdict {
  std::vector<AuditFinding> models;  ///< what the two engines' worlds hold differently
  Verdict verdict;
  std::optional<Attribution> attribution;
};

/// Holds the verdicts of many engines, from one set of runs.
struct EngineComparison {
  std::vector<JudgedEngine> engines;
  /// Lists every pair, in the order of `reach_verdicts`. Attributions are of pairs that do not agree and lie
  /// at the ends of a family; pairs at the ends of one family share theirs.
  std::vector<PairVerdict> pairs;
  Consensus consensus;
};

/// What is being done, for a line of progress, and the share of it that is done.
using StageProgress = std::function<void(const std::string& stage, double share)>;

/// The part of `progress` that a stage of that name has; nothing if nobody listens.
Progress progress_of(const StageProgress& progress, const std::string& stage);

/// Audits the worlds of two engines or more, runs the behaviour in each of them once, judges every pair, and
/// explains if asked.
/// @throws ConfigError before any long run for what is wrong with names, options or the world, for an engine
/// that is named twice, and for `explain` where no pair has a family
EngineComparison judge_engines(const LoadedBehaviour& loaded, const std::vector<std::string>& engines,
                               const JudgeOptions& options = {}, const StageProgress& progress = {});
/// The same of a behaviour that is no specification's, whose runs nothing stores.
/// @param world  that it takes place in
EngineComparison judge_engines(const Behaviour& behaviour, const WorldSpec& world,
                               const std::vector<std::string>& names, const JudgeOptions& options = {},
                               const StageProgress& progress = {});

/// The family whose ends are `a` and `b`, either way round; an engine of the same laws may stand for an end.
/// @throws ConfigError if there is none
EngineFamily find_family(const Engine& a, const Engine& b);

/// Keys as in docs/schemas/verdict.json.
nlohmann::ordered_json to_json(const PairVerdict& pair);
std::string describe(const PairVerdict& pair);
/// Keys as in docs/schemas/verdicts.json; of two engines those of their pair.
nlohmann::ordered_json to_json(const EngineComparison& comparison);
std::string describe(const EngineComparison& comparison);

}  // namespace crossgait
