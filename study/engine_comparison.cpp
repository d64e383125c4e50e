#include "study/engine_comparison.h"

#include <algorithm>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "backends/registry.h"
#include "physics/core/error.h"
#include "study/run_store.h"

namespace crossgait {

EngineFamily find_family(const Engine& a, const Engine& b) {
  const EngineFamily* found = nullptr;
  for (const EngineFamily& family : engine_families()) {
    const Laws from = find_engine(family.from).info.laws, to = find_engine(family.to).info.laws;
    if (!(a.info.laws == from && b.info.laws == to) && !(b.info.laws == from && a.info.laws == to)) continue;
    // Several releases of an engine may have changed the same law: rather the one that was asked about.
    const auto is_end = [&family](const Engine& e) {
      return e.name() == family.from || e.name() == family.to;
    };
    if (found == nullptr || is_end(a) || is_end(b)) found = &family;
  }
  if (found != nullptr) return *found;
  throw ConfigError("verdict", "explain", "two engines with known differences (mujoco and bullet)",
                    fmt::format("{} and {}", a.name(), b.name()));
}

Progress progress_of(const StageProgress& progress, const std::string& stage) {
  return progress ? Progress([progress, stage](double share) { progress(stage, share); }) : Progress();
}

namespace {

std::vector<Engine> find_engines(const std::vector<std::string>& names) {
  std::vector<Engine> engines;
  for (const std::string& name : names) {
    engines.push_back(find_engine(name));
    const auto same = [&](const Engine& e) { return e.name() == engines.back().name(); };
    if (std::count_if(engines.begin(), engines.end(), same) > 1)
      throw ConfigError("verdict", "engines", "different ones", fmt::format("'{}' twice", name));
  }
  if (engines.size() < 2)
    throw ConfigError("verdict", "engines", "two or more", fmt::format("{}", engines.size()));
  return engines;
}

// Of every pair; those without one are none, unless no pair has one.
std::vector<std::optional<EngineFamily>> find_families(const std::vector<Engine>& engines) {
  std::vector<std::optional<EngineFamily>> families;
  std::optional<ConfigError> none;
  bool any = false;
  for (std::size_t i = 0; i < engines.size(); ++i) {
    for (std::size_t k = i + 1; k < engines.size(); ++k) {
      families.emplace_back();
      try {
        families.back() = find_family(engines[i], engines[k]);
        any = true;
      } catch (const ConfigError& error) {
        none = error;
      }
    }
  }
  if (!any) throw ConfigError(*none);
  return families;
}

// Each family once, for the pairs that do not agree; of two engines, whatever they do.
void explain(EngineComparison& result, const std::vector<std::optional<EngineFamily>>& families,
             const Behaviour& behaviour, const WorldSpec& world, const JudgeOptions& options,
             const StageProgress& progress) {
  const VerdictOptions& how = options.verdict;
  std::map<std::string, Attribution> made;
  for (std::size_t p = 0; p < families.size(); ++p) {
    if (!families[p]) continue;
    if (families.size() > 1 && result.pairs[p].verdict.value() == VerdictValue::kAgrees) continue;
    const std::string ends = families[p]->from + " to " + families[p]->to;
    if (!made.contains(ends)) {
      const std::string stage = families.size() > 1 ? "explaining " + ends : "explaining";
      made.emplace(ends, attribute(behaviour, family_for(*families[p], *world.robot),
                                   {how.starts, how.confidence, how.workers}, progress_of(progress, stage)));
    }
    result.pairs[p].attribution = made.at(ends);
  }
}

}  // namespace

EngineComparison judge_engines(const LoadedBehaviour& loaded, const std::vector<std::string>& engines,
                               const JudgeOptions& options, const StageProgress& progress) {
  Behaviour behaviour = make_behaviour(loaded);
  if (!options.stored_runs.empty())
    behaviour = with_store(std::move(behaviour), loaded, std::make_shared<RunStore>(options.stored_runs));
  return judge_engines(behaviour, loaded.world(), engines, options, progress);
}

EngineComparison judge_engines(const Behaviour& behaviour, const WorldSpec& world,
                               const std::vector<std::string>& names, const JudgeOptions& options,
                               const StageProgress& progress) {
  options.verdict.validate();
  const std::vector<Engine> engines = find_engines(names);
  std::vector<std::optional<EngineFamily>> families;
  if (options.explain) families = find_families(engines);

  EngineComparison result;
  std::vector<std::unique_ptr<PhysicsBackend>> worlds;
  for (const Engine& engine : engines) {
    result.engines.push_back({engine.name(), std::string(engine.info.laws.contact_law())});
    worlds.push_back(engine.make(world));
  }
  std::vector<std::vector<AuditFinding>> models;
  for (std::size_t i = 0; i < worlds.size(); ++i) {
    for (std::size_t k = i + 1; k < worlds.size(); ++k)
      models.push_back(audit_models(*worlds[i], *worlds[k]));
  }
  const std::vector<Verdict> verdicts =
      reach_verdicts(behaviour, engines, options.verdict, progress_of(progress, "judging"));
  for (std::size_t p = 0; p < verdicts.size(); ++p)
    result.pairs.push_back({std::move(models[p]), verdicts[p], std::nullopt});
  result.consensus = find_consensus(result.engines, verdicts);
  explain(result, families, behaviour, world, options, progress);
  return result;
}

}  // namespace crossgait
