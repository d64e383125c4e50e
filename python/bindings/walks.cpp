// `crossgait walk` and `compare` as functions, with traces.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "backends/registry.h"
#include "parity/report.h"
#include "python/bindings/job.h"
#include "python/bindings/study_report.h"
#include "python/bindings/trace_numbers.h"
#include "study/policy_walk.h"
#include "study/run_spec.h"
#include "study/walk.h"

namespace crossgait::python {
namespace {

// Where a policy is of a file, what it is; of others only their names are known.
nlohmann::json policy_subject(const PolicyChoice& choice, const LoadedEnv& environment) {
  const auto* text = std::get_if<std::string>(&choice);
  if (text == nullptr) return {{"python", name_of(choice)}};
  return {{"behaviour", LoadedBehaviour(environment, *text, {}, 0).described.at("behaviour")}};
}

Pair walk_in(const Subject& subject, const std::string& engine, bool trace, const nb::object& progress) {
  const auto kept = std::make_shared<std::vector<TraceNumbers>>();
  const Report report = run_job(
      [=](const StageProgress& told) -> Report {
        const LoadedWalk loaded = config_of(subject);
        if (trace) kept->emplace_back(loaded.world.robot);
        const auto world = find_engine(engine).make(loaded.world);
        const WalkRun run = record_walk(*world, setup_of(subject), progress_of(told, "walking"),
                                        kept->empty() ? nullptr : &kept->front());
        if (run.interrupted) throw Interrupted();
        Json json = crossgait::report(run);
        json["provenance"] = provenance(subject_json(subject, loaded), {engine});
        return {json, describe(run)};
      },
      progress);
  return nb::make_tuple(to_python(report), to_python(kept));
}

Pair compare_in(const Subject& subject, const std::vector<std::string>& engines, bool trace,
                const DivergenceTolerances& tolerances, const nb::object& progress) {
  const auto kept = std::make_shared<std::vector<TraceNumbers>>();
  const Report report = run_job(
      [=](const StageProgress& told) -> Report {
        const LoadedWalk loaded = config_of(subject);
        if (trace) kept->resize(engines.size(), TraceNumbers(loaded.world.robot));
        WalkComparison result;
        result.comparison =
            compare_walks(loaded.world, setup_of(subject), engines, tolerances, told, sinks_of(kept));
        if (result.comparison.interrupted) throw Interrupted();
        Json json = crossgait::report(result);
        json["provenance"] = provenance(subject_json(subject, loaded), engines);
        return {json, describe(result.comparison)};
      },
      progress);
  return nb::make_tuple(to_python(report), to_python(kept));
}

// One episode in every engine, side by side; of one engine alone, as a walk is told of.
Pair episodes_in(const EnvConfig& environment, const PolicyChoice& choice,
                 const std::vector<std::string>& engines, std::uint64_t seed, bool trace, bool alone,
                 const DivergenceTolerances& tolerances, const nb::object& progress) {
  const auto kept = std::make_shared<std::vector<TraceNumbers>>();
  const Report report = run_job(
      [=](const StageProgress& told) {
        return with_policies(
            {choice}, told, [&](const auto& policies, const StageProgress& listening) -> Report {
              const LoadedEnv loaded = environment;
              if (trace) kept->resize(engines.size(), TraceNumbers(loaded.robot));
              WalkComparison result;
              result.comparison = compare_episodes(loaded, policies.front(), engines, seed, tolerances,
                                                   progress_of(listening, "walking"), sinks_of(kept));
              if (result.comparison.interrupted) throw Interrupted();
              const WalkRun& first = result.comparison.runs.front();
              Json json = alone ? crossgait::report(first) : crossgait::report(result);
              json["provenance"] = provenance(policy_subject(choice, loaded), engines);
              return {json, alone ? describe(first) : describe(result.comparison)};
            });
      },
      progress);
  return nb::make_tuple(to_python(report), to_python(kept));
}

DivergenceTolerances tolerances_of(double position, double joint, double attitude) {
  DivergenceTolerances tolerances;
  tolerances.position = position;
  tolerances.joint = joint;
  tolerances.attitude = attitude;
  return tolerances;
}

}  // namespace

void bind_walk_studies(nb::module_& m) {
  m.def("_walk", &walk_in, nb::arg("walk"), nb::arg("engine"), nb::arg("trace"), kProgress);
  m.def(
      "_compare",
      [](const Subject& walk, const std::vector<std::string>& engines, bool trace, double position,
         double joint, double attitude, const nb::object& progress) {
        return compare_in(walk, engines, trace, tolerances_of(position, joint, attitude), progress);
      },
      nb::arg("walk"), nb::arg("engines"), nb::arg("trace"), nb::arg("position"), nb::arg("joint"),
      nb::arg("attitude"), kProgress);
  m.def(
      "_walk_policy",
      [](const EnvConfig& environment, const PolicyChoice& policy, const std::string& engine,
         std::uint64_t seed, bool trace, const nb::object& progress) {
        return episodes_in(environment, policy, {engine}, seed, trace, true, {}, progress);
      },
      nb::arg("environment"), nb::arg("policy"), nb::arg("engine"), nb::arg("seed"), nb::arg("trace"),
      kProgress);
  m.def(
      "_compare_policy",
      [](const EnvConfig& environment, const PolicyChoice& policy, const std::vector<std::string>& engines,
         std::uint64_t seed, bool trace, double position, double joint, double attitude,
         const nb::object& progress) {
        return episodes_in(environment, policy, engines, seed, trace, false,
                           tolerances_of(position, joint, attitude), progress);
      },
      nb::arg("environment"), nb::arg("policy"), nb::arg("engines"), nb::arg("seed"), nb::arg("trace"),
      nb::arg("position"), nb::arg("joint"), nb::arg("attitude"), kProgress);
}

}  // namespace crossgait::python
