#include "study/engine_comparison.h"

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "backends/registry.h"
#include "physics/core/error.h"
#include "study/run_store.h"

namespace crossgait {
namespace {

using Names = std::set<std::string>;

// The factors of a family that an engine by this name has; empty if it is none of the family.
std::optional<Names> factors_of(const EngineFamily& family, const std::string& engine) {
  for (unsigned mask = 0; mask < 1U << family.factors.size(); ++mask) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < family.factors.size(); ++i) {
      if ((mask >> i & 1U) != 0) names.push_back(family.factors[i].name);
    }
    const Names set(names.begin(), names.end());
    const bool has_meaning =
        std::all_of(family.factors.begin(), family.factors.end(), [&](const ModelFactor& f) {
          return !set.contains(f.name) || std::all_of(f.needs.begin(), f.needs.end(),
                                                      [&](const std::string& n) { return set.contains(n); });
        });
    if (has_meaning && family.with(names).name() == engine) return set;
  }
  return std::nullopt;
}

// The part of a family between two engines of it, the one of which has all factors of the other.
std::optional<EngineFamily> family_part(const EngineFamily& family, const std::string& a,
                                        const std::string& b) {
  const std::optional<Names> from = factors_of(family, a), to = factors_of(family, b);
  if (!from || !to || from == to) return std::nullopt;
  if (!std::includes(to->begin(), to->end(), from->begin(), from->end()))
    return std::includes(from->begin(), from->end(), to->begin(), to->end()) ? family_part(family, b, a)
                                                                             : std::nullopt;
  EngineFamily part{a, b, {}, {}};
  for (ModelFactor factor : family.factors) {
    if (!to->contains(factor.name) || from->contains(factor.name)) continue;
    std::erase_if(factor.needs, [&](const std::string& need) { return from->contains(need); });
    part.factors.push_back(std::move(factor));
  }
  part.with = [with = family.with, always = *from,
               order = family.factors](const std::vector<std::string>& names) {
    std::vector<std::string> all;
    for (const ModelFactor& factor : order) {
      const bool asked = std::find(names.begin(), names.end(), factor.name) != names.end();
      if (asked || always.contains(factor.name)) all.push_back(factor.name);
    }
    return with(all);
  };
  return part;
}

// Whether laws are the same but for how they are solved, which stands behind a slash.
bool alike(const Laws& a, const Laws& b) {
  const auto law = [](const std::string& name) { return name.substr(0, name.find('/')); };
  const auto same = [&](std::string Laws::*field) { return law(a.*field) == law(b.*field); };
  return same(&Laws::contact) && same(&Laws::loops) && same(&Laws::joint_friction) &&
         same(&Laws::joint_limits) && same(&Laws::couplings) && same(&Laws::implicit_servos);
}

// From an engine beside a family, of the laws of its first, to its last: the other dynamics are a factor too.
std::optional<EngineFamily> joined_family(const EngineFamily& family, const Engine& a, const Engine& b) {
  if (b.name() != family.to || !alike(a.info.laws, find_engine(family.from).info.laws)) return std::nullopt;
  const std::string dynamics = "dynamics";
  EngineFamily joined{a.name(), family.to, {}, {}};
  joined.factors.push_back(
      {dynamics,
       fmt::format("{}, of the same laws: another code for dynamics, solved otherwise", family.from),
       {}});
  for (ModelFactor factor : family.factors) {
    factor.needs.insert(factor.needs.begin(), dynamics);
    joined.factors.push_back(std::move(factor));
  }
  joined.with = [with = family.with, a, dynamics](std::vector<std::string> names) {
    return std::erase(names, dynamics) > 0 ? with(names) : a;
  };
  return joined;
}

}  // namespace

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
  for (const EngineFamily& family : engine_families()) {
    if (const auto part = family_part(family, a.name(), b.name())) return *part;
  }
  for (const EngineFamily& family : engine_families()) {
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
      if (const auto joined = joined_family(family, from, to)) return *joined;
    }
  }
  throw ConfigError(
      "verdict", "explain",
      "two engines with known differences: mujoco and bullet, or one with some factors of the other",
      fmt::format("{} and {}", a.name(), b.name()));
}

Progress progress_of(const StageProgress& progress, const std::string& stage) {
  return progress ? Progress([progress, stage](double share) { progress(stage, share); }) : Progress();
}

namespace {

std::vector<Engine> find_engines(const std::vector<std::string>& names, const JudgeOptions& options) {
  std::vector<Engine> engines;
  for (const std::string& name : names) {
    engines.push_back(find_engine(name));
    const auto same = [&](const Engine& e) { return e.name() == engines.back().name(); };
    if (std::count_if(engines.begin(), engines.end(), same) > 1)
      throw ConfigError("verdict", "engines", "different ones", fmt::format("'{}' twice", name));
  }
  if (options.against) {
    std::vector<Engine> both;
    for (const Engine& engine : engines) {
      both.push_back(engine);
      both.push_back(with_setup(engine, *options.against));
    }
    engines = std::move(both);
  }
  if (engines.size() < 2)
    throw ConfigError("verdict", "engines", "two or more", fmt::format("{}", engines.size()));
  return engines;
}

// Of every pair; those without one are none, unless no pair has one.
std::vector<std::optional<EngineFamily>> find_families(const std::vector<Engine>& engines,
                                                       const JudgeOptions& options) {
  std::vector<std::optional<EngineFamily>> families;
  std::optional<ConfigError> none;
  bool any = false;
  for (std::size_t i = 0; i < engines.size(); ++i) {
    for (std::size_t k = i + 1; k < engines.size(); ++k) {
      families.emplace_back();
      if (options.against) {
        // Each engine is followed by itself under the setup. Of others the factors are those of plain worlds.
        if (i % 2 == 0 && k == i + 1) {
          families.back() = setup_family(engines[i], *options.against);
          any = true;
        }
        if (i % 2 == 1 || k % 2 == 1) continue;
      }
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
    if (families.size() > 1 && result.verdicts.pairs[p].word == Word::kAgrees) continue;
    const std::string ends = families[p]->from + " to " + families[p]->to;
    if (!made.contains(ends)) {
      const std::string stage = families.size() > 1 ? "explaining " + ends : "explaining";
      made.emplace(
          ends,
          attribute(with_margins(behaviour, how.margins), family_for(*families[p], *world.robot),
                    {how.starts, how.confidence, how.workers, how.failures}, progress_of(progress, stage)));
    }
    result.backgrounds[p].attribution = made.at(ends);
  }
}

// How many starts a store has been asked for before, as asked and in all engines; 0 if none, or all of them.
std::size_t starts_held(const RunStore& store, const LoadedBehaviour& loaded,
                        const std::vector<Engine>& engines, std::size_t starts) {
  std::size_t held = 0;
  for (std::size_t k = 0; k < starts; ++k) {
    const bool all = std::all_of(engines.begin(), engines.end(), [&](const Engine& engine) {
      return store.find(describe_run(loaded.described, engine.info, nominal_variation(), k, kToTheEnd))
          .has_value();
    });
    held += all ? 1 : 0;
  }
  return held == starts ? 0 : held;
}

}  // namespace

EngineComparison judge_engines(const LoadedBehaviour& loaded, const std::vector<std::string>& engines,
                               const JudgeOptions& options, const StageProgress& progress) {
  const Behaviour behaviour = make_behaviour(loaded);
  if (options.stored_runs.empty())
    return judge_engines(behaviour, loaded.world(), engines, options, progress);
  options.verdict.validate();
  const std::vector<Engine> found = find_engines(engines, options);  // before a file is made
  const auto store = std::make_shared<RunStore>(options.stored_runs);
  const std::size_t held = starts_held(*store, loaded, found, options.verdict.starts);
  EngineComparison result =
      judge_engines(with_store(behaviour, loaded, store), loaded.world(), engines, options, progress);
  result.starts_held = held;
  store->check_place();
  return result;
}

EngineComparison judge_engines(const Behaviour& behaviour, const WorldSpec& world,
                               const std::vector<std::string>& names, const JudgeOptions& options,
                               const StageProgress& progress) {
  options.verdict.validate();
  const std::vector<Engine> engines = find_engines(names, options);
  std::vector<std::optional<EngineFamily>> families;
  if (options.explain) families = find_families(engines, options);

  EngineComparison result;
  result.contact = world.contact;
  result.against = options.against;
  std::vector<std::unique_ptr<PhysicsBackend>> worlds;
  for (const Engine& engine : engines) {
    const Laws& laws = engine.info.laws;
    result.engines.push_back({engine.name(), std::string(laws.contact_law()), laws.contact_family});
    result.infos.push_back(engine.info);
    worlds.push_back(engine.make(world));
  }
  for (std::size_t i = 0; i < worlds.size(); ++i) {
    for (std::size_t k = i + 1; k < worlds.size(); ++k) {
      result.backgrounds.push_back({audit_models(*worlds[i], *worlds[k]),
                                    shared_parts(engines[i].info, engines[k].info), std::nullopt});
    }
  }
  if (behaviour.notes) result.notes = behaviour.notes(engines.front());
  result.verdicts = reach_verdicts(behaviour, engines, options.verdict, progress_of(progress, "judging"));
  result.consensus = find_consensus(result.engines, result.verdicts.pairs);
  explain(result, families, behaviour, world, options, progress);
  return result;
}

Word word_of(const EngineComparison& comparison) noexcept { return worst_word(comparison.verdicts.pairs); }

std::vector<std::string> names_of(const EngineComparison& comparison,
                                  const std::vector<std::size_t>& places) {
  std::vector<std::string> names;
  for (const std::size_t i : places) names.push_back(comparison.engines[i].name);
  return names;
}

}  // namespace crossgait
