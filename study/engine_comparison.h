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
#include "study/setup.h"

namespace crossgait {

struct JudgeOptions {
  VerdictOptions verdict;
  bool explain = false;          ///< also say what the gap comes from
  std::string stored_runs = {};  ///< file of runs to take and to add to (RunStore); empty: none
  /// Every engine also under another setup of the world: each of them is followed by another "engine", itself
  /// with the setup. One engine is enough.
  std::optional<WorldSetup> against = {};
};

/// Holds what belongs to a pair's verdict.
struct PairBackground {
  ModelAudit models;                ///< what the two engines' worlds hold differently
  std::vector<std::string> shared;  ///< what they agree in because it is the same code (shared_parts)
  std::optional<Attribution> attribution;
};

/// Holds the verdicts of two engines or more, from one set of runs.
struct EngineComparison {
  std::vector<JudgedEngine> engines;
  std::vector<EngineInfo> infos;  ///< of the same
  ContactSpec contact;
  std::optional<WorldSetup> against;  ///< under which every second engine is the one before it
  Verdicts verdicts;
  /// Background of each pair. Attributions are of pairs that do not agree and lie at the ends of a family;
  /// pairs at the ends of one family share theirs.
  std::vector<PairBackground> backgrounds;
  Consensus consensus;
  /// Starts that `stored_runs` held already, if not all: whoever has looked at those looks again now.
  std::size_t starts_held = 0;
  std::vector<std::string>
      notes;  ///< what is doubtful of the behaviour, by its first run in the first engine
};

/// Returns the word for all engines: the worst of the pairs.
Word word_of(const EngineComparison& comparison) noexcept;
/// Names the engines at these places.
std::vector<std::string> names_of(const EngineComparison& comparison, const std::vector<std::size_t>& places);

/// Tells what is being done, for a line of progress, and the share of it that is done.
using StageProgress = std::function<void(const std::string& stage, double share)>;

/// Returns the part of `progress` that a stage of that name has; nothing if nobody listens.
Progress progress_of(const StageProgress& progress, const std::string& stage);

/// Audits all worlds, runs the behaviour in every engine, judges all pairs, and explains if asked; no engine
/// is run twice.
/// @throws ConfigError before any long run for what is wrong with names, options or the world; also for an
/// engine that is named twice, and for `explain` where no pair has a family
EngineComparison judge_engines(const LoadedBehaviour& loaded, const std::vector<std::string>& engines,
                               const JudgeOptions& options = {}, const StageProgress& progress = {});
/// Judges a behaviour that is no specification's, whose runs nothing stores.
/// @param world  that it takes place in
EngineComparison judge_engines(const Behaviour& behaviour, const WorldSpec& world,
                               const std::vector<std::string>& names, const JudgeOptions& options = {},
                               const StageProgress& progress = {});

/// Finds the family whose ends are `a` and `b`, either way round; an engine of the same laws may stand for an
/// end. Else the part of one between two engines of which one has some of the other's factors
/// ("bullet:matched" and "bullet:matched+coulomb"). Else one whose `from` has the laws of `a` or `b` but for
/// how they are solved and whose `to` is the other, with a first factor "dynamics" for what lies between.
/// @throws ConfigError if there is none
EngineFamily find_family(const Engine& a, const Engine& b);

/// Says what a colleague can repeat, in one to three sentences: what depends on the engine, what does not,
/// why, and how sure that is.
std::string summary(const EngineComparison& comparison);
/// Writes keys as in docs/schemas/verdict.json.
nlohmann::ordered_json to_json(const EngineComparison& comparison);
/// Writes the summary first, then tables, then how the words were reached.
std::string describe(const EngineComparison& comparison);

}  // namespace crossgait
