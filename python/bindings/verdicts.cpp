// `crossgait verdict` as a function, of walks and of policies.
#include <map>
#include <optional>
#include <tuple>

#include <fmt/format.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "env/env_model.h"
#include "physics/core/error.h"
#include "python/bindings/job.h"
#include "python/bindings/study_report.h"
#include "study/engine_comparison.h"

namespace crossgait::python {
namespace {

// `verdict(...)`'s options: starts, looks, confidence, margins as text, workers, explain, runs, the setup to
// hold it against as text.
using HowToJudge = std::tuple<std::size_t, std::size_t, double, std::map<std::string, std::string>,
                              std::size_t, bool, std::string, std::optional<std::string>>;

struct JudgeCall {
  JudgeOptions options;
  std::optional<std::string> against;  ///< read when there is a world

  /// In the thread that judges, which is the one whose files are recorded.
  JudgeOptions in(const WorldSpec& world) const {
    JudgeOptions read = options;
    if (against) read.against = read_setup(*against, world, "against");
    return read;
  }
};

JudgeCall judge_call(const HowToJudge& how) {
  const auto& [starts, looks, confidence, margins, workers, explain, runs, against] = how;
  JudgeOptions options;
  options.verdict.starts = starts;
  options.verdict.looks = looks;
  options.verdict.confidence = confidence;
  options.verdict.workers = workers;
  for (const auto& [key, text] : margins) options.verdict.margins[key] = parse_margin(text, "margins", key);
  options.explain = explain;
  options.stored_runs = runs;
  return {options, against};
}

// The document of `crossgait verdict`.
Report report_of(const EngineComparison& judged, const Json& made) {
  Json json = to_json(judged);
  json["provenance"] = made;
  return {json, describe(judged)};
}

void refuse_stored_runs(const JudgeOptions& options) {
  if (!options.stored_runs.empty())
    throw ConfigError("verdict", "runs", "none: what is in no file has no identity to be found by",
                      options.stored_runs);
}

Pair judge(const BehaviourSpec& spec, const std::vector<std::string>& engines, const JudgeCall& call,
           const nb::object& progress) {
  return to_python(run_job(
      [=](const StageProgress& told) -> Report {
        const LoadedBehaviour loaded = spec;
        const JudgeOptions options = call.in(loaded.world());
        return report_of(judge_engines(loaded, engines, options, told),
                         provenance(loaded.described, engines));
      },
      progress));
}

Pair judge(const PythonController& behaviour, const StartRanges& starts_from, std::uint64_t seed,
           const std::vector<std::string>& engines, const JudgeCall& call, const nb::object& progress) {
  refuse_stored_runs(call.options);
  return to_python(run_job(
      [=](const StageProgress& told) -> Report {
        const LoadedWalk loaded = behaviour.walk;
        const JudgeOptions options = call.in(loaded.world);
        return report_of(judge_engines(make_behaviour(loaded, behaviour.setup(), starts_from, seed),
                                       loaded.world, engines, options, told),
                         provenance(subject_json(behaviour, loaded), engines));
      },
      progress));
}

Pair judge(const EnvConfig& environment, const PolicyChoice& policy, const StartRanges& starts_from,
           std::uint64_t seed, const std::vector<std::string>& engines, const JudgeCall& call,
           const nb::object& progress) {
  refuse_stored_runs(call.options);
  return to_python(run_job(
      [=](const StageProgress& told) {
        return with_policies(
            {policy}, told, [&](const auto& policies, const StageProgress& listening) -> Report {
              const LoadedEnv loaded = environment;
              const WorldSpec world = EnvModel::make(loaded)->world;
              const JudgeOptions options = call.in(world);
              const Behaviour behaviour =
                  policy_behaviour(loaded, policies.front().make, policies.front().name, starts_from, seed);
              return report_of(judge_engines(behaviour, world, engines, options, listening),
                               provenance({{"python", name_of(policy)}}, engines));
            });
      },
      progress));
}

// What it is made of: position_m, heading_rad, push_mps.
using RangesState = std::tuple<std::optional<double>, double, std::optional<double>>;

void check_range(const char* name, double value, double most) {
  if (!(value >= 0 && value <= most))
    throw ConfigError("StartRanges", name, fmt::format("0 to {:g}", most), fmt::format("{}", value));
}

StartRanges ranges_of(const RangesState& state) {
  const auto& [position_m, heading_rad, push_mps] = state;
  check_range("position_m", position_m.value_or(0), StartRanges::kMostPosition);
  check_range("heading_rad", heading_rad, StartRanges::kMostHeading);
  check_range("push_mps", push_mps.value_or(0), StartRanges::kMostPush);
  return {position_m, heading_rad, StartRanges().tilt_rad, push_mps};
}

std::string repr_of(const StartRanges& r) {
  const auto text = [](const std::optional<double>& number) {
    return number ? fmt::format("{}", *number) : "None";
  };
  return fmt::format("StartRanges(position_m={}, heading_rad={}, push_mps={})", text(r.position_m),
                     r.heading_rad, text(r.push_mps));
}

}  // namespace

void bind_verdicts(nb::module_& m) {
  nb::class_<StartRanges>(m, "StartRanges", "How far apart the starts of a verdict lie.")
      .def(
          "__init__",
          [](StartRanges* self, std::optional<double> position_m, double heading_rad,
             std::optional<double> push_mps) {
            new (self) StartRanges(ranges_of({position_m, heading_rad, push_mps}));
          },
          nb::kw_only(), nb::arg("position_m") = nb::none(),
          nb::arg("heading_rad") = StartRanges().heading_rad, nb::arg("push_mps") = nb::none())
      .def_ro("position_m", &StartRanges::position_m, "Each way along x and y; None: by the robot's size.")
      .def_ro("heading_rad", &StartRanges::heading_rad, "Each way.")
      .def_ro("push_mps", &StartRanges::push_mps,
              "The speed that one push would give to the robot; None: by its size.")
      .def("__repr__", [](const StartRanges& r) { return repr_of(r); })
      .def("__getstate__",
           [](const StartRanges& r) { return RangesState(r.position_m, r.heading_rad, r.push_mps); })
      .def("__setstate__",
           [](StartRanges& self, const RangesState& state) { new (&self) StartRanges(ranges_of(state)); });
  m.def(
      "_judge_walk",
      [](const Subject& walk, const std::vector<std::string>& engines, const StartRanges& starts_from,
         std::uint64_t seed, const HowToJudge& how, const nb::object& progress) {
        const JudgeCall call = judge_call(how);
        if (const auto* config = std::get_if<PythonWalk>(&walk))
          return judge({*config, starts_from, seed}, engines, call, progress);
        return judge(std::get<PythonController>(walk), starts_from, seed, engines, call, progress);
      },
      nb::arg("walk"), nb::arg("engines"), nb::arg("starts_from"), nb::arg("seed"), nb::arg("how"),
      kProgress);
  m.def(
      "_judge_policy",
      [](const EnvConfig& environment, const PolicyChoice& policy, const std::vector<std::string>& engines,
         const StartRanges& starts_from, std::uint64_t seed, const HowToJudge& how,
         const nb::object& progress) {
        const JudgeCall call = judge_call(how);
        if (environment.extension != nullptr) refuse_stored_runs(call.options);  // terms are functions
        if (const auto* text = std::get_if<std::string>(&policy))
          return judge({PolicyConfig{environment, *text}, starts_from, seed}, engines, call, progress);
        return judge(environment, policy, starts_from, seed, engines, call, progress);
      },
      nb::arg("environment"), nb::arg("policy"), nb::arg("engines"), nb::arg("starts_from"), nb::arg("seed"),
      nb::arg("how"), kProgress);
}

}  // namespace crossgait::python
