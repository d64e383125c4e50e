#include "study/walk.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "parity/answer.h"
#include "parity/report.h"
#include "parity/verdict_report.h"
#include "physics/core/error.h"
#include "physics/core/schema.h"

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

Comparison compare_walks(const WorldSpec& world, const WalkSetup& setup,
                         const std::vector<std::string>& engines, const DivergenceTolerances& tolerances,
                         const StageProgress& progress, const TraceSinks& sinks) {
  check_engines(engines);
  std::vector<std::unique_ptr<PhysicsBackend>> worlds;
  for (const std::string& engine : engines) worlds.push_back(find_engine(engine).make(world));
  const AnotherWorld another = [&](std::size_t place) { return find_engine(engines[place]).make(world); };
  return compare_engines(worlds, setup, tolerances, progress_of(progress, "comparing"), sinks, another);
}

namespace {

// Of engines that solve different laws; of the same laws parity is the question.
std::optional<EngineComparison> judge_walks(const LoadedWalk& loaded, const std::vector<std::string>& names,
                                            const VerdictOptions& options, const StageProgress& progress) {
  std::vector<std::string> engines;
  for (const std::string& name : names) {
    const auto same_laws = [&name](const std::string& other) {
      return find_engine(name).info.laws == find_engine(other).info.laws;
    };
    if (std::none_of(engines.begin(), engines.end(), same_laws)) engines.push_back(name);
  }
  if (engines.size() < 2) return std::nullopt;
  return judge_engines({loaded, {}, loaded.config.terrain_seed}, engines, {.verdict = options}, progress);
}

}  // namespace

WalkComparison compare_walks(const LoadedWalk& loaded, const std::vector<std::string>& engines,
                             const CompareOptions& options, const StageProgress& progress,
                             const TraceSinks& sinks) {
  WalkComparison result;
  result.comparison =
      compare_walks(loaded.world, loaded.config.setup(), engines, options.tolerances, progress, sinks);
  result.interrupted = result.comparison.interrupted;
  if (!options.verdict || result.interrupted) return result;
  try {
    result.verdict = judge_walks(loaded, engines, options.judge, progress);
  } catch (const Interrupted&) {
    result.interrupted = true;
  }
  return result;
}

nlohmann::ordered_json report(const WalkRun& run) {
  nlohmann::ordered_json json{{"summary", summary(run)}};
  json.update(to_json(run));
  return with_schema("walk", json);
}

nlohmann::ordered_json report(const WalkComparison& result) {
  nlohmann::ordered_json json = with_schema("compare", to_json(result.comparison));
  if (result.interrupted) json["interrupted"] = true;
  if (result.verdict) {
    json["verdict"] = to_json(*result.verdict);
    json["verdict"].erase("schema");
  }
  return json;
}

}  // namespace crossgait
