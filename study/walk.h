// Walks and comparisons as `crossgait walk` and `crossgait compare` make them.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "crossgait/parity/verdict.h"
#include "crossgait/study/judgement.h"

namespace crossgait {

/// One walk in one engine, with its trace. @throws ConfigError
WalkRun walk(const WalkConfig& config, const std::string& engine, const Progress& progress = {});

struct CompareOptions {
  DivergenceTolerances tolerances;  ///< for engines of different laws
  bool verdict = false;             ///< also judge every pair of engines of different laws
  VerdictOptions judge{.starts = 6};
};

struct WalkComparison {
  Comparison comparison;
  std::vector<Verdict> verdicts;  ///< empty unless asked for
};

/// The same walk in every engine. @throws ConfigError for fewer than two engines, or one twice
WalkComparison compare_walks(const WalkConfig& config, const std::vector<std::string>& engines,
                             const CompareOptions& options = {}, const StageProgress& progress = {});

/// With their schemas: docs/schemas/walk.json and compare.json.
nlohmann::ordered_json report(const WalkRun& run);
nlohmann::ordered_json report(const WalkComparison& comparison);

}  // namespace crossgait
