// Walks and comparisons as `crossgait walk` and `crossgait compare` make them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "study/engine_comparison.h"

namespace crossgait {

struct CompareOptions {
  DivergenceTolerances tolerances;  ///< for engines of different laws
  bool verdict = false;             ///< also judge the first engine of each set of laws
  VerdictOptions judge{.starts = 6};
};

struct WalkComparison {
  Comparison comparison;
  std::optional<EngineComparison> verdict;  ///< empty unless asked for, or where all solve the same laws
  bool interrupted = false;                 ///< before its end, by a progress that threw Interrupted
};

/// Runs the same walk in every engine. An interruption leaves the walks up to the same step, or the walks
/// without a verdict. @throws ConfigError for fewer than two engines, or one twice
WalkComparison compare_walks(const LoadedWalk& loaded, const std::vector<std::string>& engines,
                             const CompareOptions& options = {}, const StageProgress& progress = {},
                             const TraceSinks& sinks = {});

/// Runs any walk in its world in every engine, without a verdict.
Comparison compare_walks(const WorldSpec& world, const WalkSetup& setup,
                         const std::vector<std::string>& engines, const DivergenceTolerances& tolerances = {},
                         const StageProgress& progress = {}, const TraceSinks& sinks = {});

/// Writes results with their schemas: docs/schemas/walk.json and compare.json.
nlohmann::ordered_json report(const WalkRun& run);
nlohmann::ordered_json report(const WalkComparison& result);

}  // namespace crossgait
