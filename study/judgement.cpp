#include "crossgait/study/judgement.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crossgait/backends/registry.h"
#include "crossgait/parity/schema.h"
#include "crossgait/parity/verdict_report.h"
#include "crossgait/physics/error.h"
#include "crossgait/study/run_store.h"

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

WorldSpec world_of(const BehaviourSpec& spec) {
  if (const auto* walk = std::get_if<WalkConfig>(&spec.what)) return walk->world();
  return EnvModel::make(std::get<PolicyConfig>(spec.what).environment)->world;
}

Judgement judge_behaviour(const BehaviourSpec& spec, const std::string& a, const std::string& b,
                          const JudgementOptions& options, const StageProgress& progress) {
  Behaviour behaviour = make_behaviour(spec);
  if (!options.stored_runs.empty())
    behaviour = with_store(std::move(behaviour), spec, std::make_shared<RunStore>(options.stored_runs));
  return judge_behaviour(behaviour, world_of(spec), a, b, options, progress);
}

Judgement judge_behaviour(const Behaviour& behaviour, const WorldSpec& world, const std::string& a,
                          const std::string& b, const JudgementOptions& options,
                          const StageProgress& progress) {
  options.verdict.validate();
  const Engine engine_a = find_engine(a), engine_b = find_engine(b);
  std::optional<EngineFamily> family;
  if (options.explain) family = find_family(engine_a, engine_b);

  Judgement result;
  const auto world_a = engine_a.make(world), world_b = engine_b.make(world);
  result.models = audit_models(*world_a, *world_b);
  result.verdict =
      reach_verdict(behaviour, engine_a, engine_b, options.verdict, progress_of(progress, "judging"));
  if (family) {
    const VerdictOptions& how = options.verdict;
    result.attribution =
        attribute(behaviour, family_for(*family, *world.robot), {how.starts, how.confidence, how.workers},
                  progress_of(progress, "explaining"));
  }
  return result;
}

nlohmann::ordered_json to_json(const Judgement& judgement) {
  nlohmann::ordered_json json = with_schema("verdict", to_json(judgement.verdict));
  json["models"] = to_json(judgement.models);
  if (judgement.attribution) json["attribution"] = to_json(*judgement.attribution);
  return json;
}

std::string describe(const Judgement& judgement) {
  std::string text =
      fmt::format("{}\nModels: {}.\n", describe(judgement.verdict), describe(judgement.models));
  if (judgement.attribution) text += fmt::format("\n{}", describe(*judgement.attribution));
  return text;
}

}  // namespace crossgait
