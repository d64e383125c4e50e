#include "crossgait/study/walk.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crossgait/backends/registry.h"
#include "crossgait/parity/report.h"
#include "crossgait/parity/schema.h"
#include "crossgait/parity/verdict_report.h"
#include "crossgait/physics/error.h"

namespace crossgait {
namespace {

void check_engines(const std::vector<std::string>& engines) {
  if (engines.size() < 2)
    throw ConfigError("compare", "--engines", "two or more engines", fmt::format("{}", engines.size()));
  for (auto it = engines.begin(); it != engines.end(); ++it) {
    if (std::find(engines.begin(), it, *it) != it)
      throw ConfigError("compare", "--engines", "each engine once", *it + " again");
  }
}

}  // namespace

WalkRun walk(const WalkConfig& config, const std::string& engine, const Progress& progress,
             const SampleObserver& observer) {
  const auto world = find_engine(engine).make(config.world());
  return record_walk(*world, config.setup(), progress, observer);
}

Comparison compare_walks(const WorldSpec& world, const WalkSetup& setup,
                         const std::vector<std::string>& engines, const DivergenceTolerances& tolerances,
                         const StageProgress& progress, const SampleObserver& observer) {
  check_engines(engines);
  std::vector<std::unique_ptr<PhysicsBackend>> worlds;
  for (const std::string& engine : engines) worlds.push_back(find_engine(engine).make(world));
  return compare_engines(worlds, setup, tolerances, progress_of(progress, "comparing"), observer);
}

WalkComparison compare_walks(const WalkConfig& config, const std::vector<std::string>& engines,
                             const CompareOptions& options, const StageProgress& progress,
                             const SampleObserver& observer) {
  WalkComparison result;
  result.comparison =
      compare_walks(config.world(), config.setup(), engines, options.tolerances, progress, observer);
  result.interrupted = result.comparison.interrupted;
  if (!options.verdict || result.interrupted) return result;
  const Behaviour behaviour = make_behaviour({config, {}, config.terrain_seed});
  for (const PairDifference& pair : result.comparison.pairs) {
    if (pair.same_laws) continue;
    const Engine a = find_engine(pair.a), b = find_engine(pair.b);
    const std::string stage = fmt::format("judging {} and {}", pair.a, pair.b);
    try {
      result.verdicts.push_back(reach_verdict(behaviour, a, b, options.judge, progress_of(progress, stage)));
    } catch (const Interrupted&) {
      result.interrupted = true;
      break;
    }
  }
  return result;
}

nlohmann::ordered_json report(const WalkRun& run) { return with_schema("walk", to_json(run)); }

nlohmann::ordered_json report(const WalkComparison& result) {
  nlohmann::ordered_json json = with_schema("compare", to_json(result.comparison));
  if (result.interrupted) json["interrupted"] = true;
  for (const Verdict& verdict : result.verdicts) json["verdicts"].push_back(to_json(verdict));
  return json;
}

}  // namespace crossgait
