#include "study/walk.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
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
  return compare_engines(worlds, setup, tolerances, progress_of(progress, "comparing"), sinks);
}

namespace {

// Of pairs of different laws; no engine is run twice.
std::vector<Verdict> judge_walks(const LoadedWalk& loaded, const std::vector<std::string>& names,
                                 const VerdictOptions& options, const StageProgress& progress) {
  std::vector<Engine> engines;
  for (const std::string& name : names) engines.push_back(find_engine(name));
  const auto same_laws = [](const Engine& a, const Engine& b) { return a.info.laws == b.info.laws; };
  if (std::all_of(engines.begin(), engines.end(), [&](const Engine& e) { return same_laws(e, engines[0]); }))
    return {};
  std::vector<Verdict> verdicts = reach_verdicts(make_behaviour({loaded, {}, loaded.config.terrain_seed}),
                                                 engines, options, progress_of(progress, "judging"));
  std::erase_if(verdicts, [&](const Verdict& v) { return same_laws(find_engine(v.a), find_engine(v.b)); });
  return verdicts;
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
    result.verdicts = judge_walks(loaded, engines, options.judge, progress);
  } catch (const Interrupted&) {
    result.interrupted = true;
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
