// The commands as functions: what they return is what `--json` writes, without the provenance of a command
// line.
#include <algorithm>

#include <fmt/format.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "backends/registry.h"
#include "benchmarks/bench.h"
#include "conformance/card.h"
#include "parity/report.h"
#include "python/bindings/arrays.h"
#include "python/bindings/behaviour.h"
#include "python/bindings/bindings.h"
#include "python/bindings/job.h"
#include "python/bindings/json.h"
#include "python/bindings/python_policy.h"
#include "python/bindings/walk_config.h"
#include "study/course.h"
#include "study/engine_comparison.h"
#include "study/provenance.h"
#include "study/rollout.h"
#include "study/tune.h"
#include "study/walk.h"

namespace crossgait::python {
namespace {

using Json = nlohmann::ordered_json;
using Pair = nb::typed<nb::tuple, nb::any, nb::any>;

// A function of a stage and a share, or None.
const auto kProgress = nb::arg("progress").none();

/// A result as JSON and as the table that a command prints.
struct Report {
  Json json;
  std::string text;
};

Pair to_python(const Report& report) { return nb::make_tuple(python::to_python(report.json), report.text); }

Json provenance(const nlohmann::json& subject, const std::vector<std::string>& engines) {
  Provenance made;
  made.command = "python";
  made.subject = subject;
  for (const std::string& name : engines) made.engines.push_back(find_engine(name).info);
  return to_json(made);
}

/// Keeps a run as a table of numbers: rows of the columns of a trace.
class TraceNumbers final : public TraceSink {
 public:
  explicit TraceNumbers(std::shared_ptr<const RobotDescription> robot) : robot_(std::move(robot)) {}

  void add(const TraceSample& sample) override {
    if (!columns_) columns_.emplace(*robot_, sample);
    columns_->append(sample, numbers_);
  }
  std::vector<std::string> names() const { return columns_ ? columns_->names() : std::vector<std::string>(); }
  nb::object table() const {
    const std::size_t width = columns_ ? columns_->names().size() : 1;
    const NewArray<double> table(numbers_.size() / width, width);
    std::copy(numbers_.begin(), numbers_.end(), table.data);
    return table.array;
  }

 private:
  std::shared_ptr<const RobotDescription> robot_;
  std::optional<TraceColumns> columns_;
  std::vector<double> numbers_;
};

/// One for each run, or none. A job whose caller is gone may go on filling them.
using Traces = std::shared_ptr<std::vector<TraceNumbers>>;

Traces traces(bool asked, std::size_t runs, const LoadedWalk& loaded) {
  return std::make_shared<std::vector<TraceNumbers>>(asked ? runs : 0, TraceNumbers(loaded.world.robot));
}

TraceSinks sinks_of(const Traces& traces) {
  TraceSinks sinks;
  for (TraceNumbers& trace : *traces) sinks.push_back(&trace);
  return sinks;
}

// Names of the columns, and a table for each run; None if there is no trace.
nb::object to_python(const Traces& traces) {
  if (traces->empty()) return nb::none();
  nb::list tables;
  for (const TraceNumbers& trace : *traces) tables.append(trace.table());
  return nb::make_tuple(traces->front().names(), tables);
}

// What a walk is made of, for whoever wants to make it again. Of a function in Python only its world can be
// said.
nlohmann::json subject_json(const Subject& subject, const LoadedWalk& loaded) {
  if (std::holds_alternative<WalkConfig>(subject))
    return {{"behaviour", LoadedBehaviour(loaded, {}, 0).described.at("behaviour")}};
  return {{"python", std::get<PythonController>(subject).name}};
}

Pair walk_in(const Subject& subject, const std::string& engine, bool trace, const nb::object& progress) {
  const LoadedWalk loaded = config_of(subject);
  const Traces kept = traces(trace, 1, loaded);
  const Report report = run_job(
      [=](const StageProgress& told) -> Report {
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
  const LoadedWalk loaded = config_of(subject);
  const Traces kept = traces(trace, engines.size(), loaded);
  const Report report = run_job(
      [=](const StageProgress& told) -> Report {
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

JudgeOptions judge_options(std::size_t starts, double limit, double confidence, std::size_t workers,
                           bool explain, const std::string& runs) {
  JudgeOptions options;
  options.verdict = {starts, limit, confidence, workers};
  options.explain = explain;
  options.stored_runs = runs;
  return options;
}

Report report_of(const EngineComparison& judged, const Json& made) {
  Json json = to_json(judged);
  json["provenance"] = made;
  return {json, describe(judged)};
}

Pair judge(const BehaviourSpec& spec, const std::vector<std::string>& engines, const JudgeOptions& options,
           const nb::object& progress) {
  return to_python(run_job(
      [=](const StageProgress& told) -> Report {
        const LoadedBehaviour loaded = spec;
        return report_of(judge_engines(loaded, engines, options, told),
                         provenance(loaded.described, engines));
      },
      progress));
}

void refuse_stored_runs(const JudgeOptions& options) {
  if (!options.stored_runs.empty())
    throw ConfigError("verdict", "runs",
                      "none: what a function in Python does has no identity to be found by",
                      options.stored_runs);
}

Pair judge(const PythonController& behaviour, const StartRanges& starts_from, std::uint64_t seed,
           const std::vector<std::string>& engines, const JudgeOptions& options, const nb::object& progress) {
  refuse_stored_runs(options);
  return to_python(run_job(
      [=](const StageProgress& told) -> Report {
        const LoadedWalk loaded = behaviour.walk;
        return report_of(judge_engines(make_behaviour(loaded, behaviour.setup(), starts_from, seed),
                                       loaded.world, engines, options, told),
                         provenance(subject_json(behaviour, loaded), engines));
      },
      progress));
}

// `work(policies, progress)`, and what a policy in Python raised, if one did.
template <typename Work>
Report with_policies(const std::vector<PolicyChoice>& choices, const StageProgress& told, const Work& work) {
  const auto failure = std::make_shared<FirstFailure>();
  std::vector<NamedPolicy> policies;
  for (const PolicyChoice& choice : choices) policies.push_back(named(choice, failure));
  try {
    Report report = work(policies, until(failure, told));
    failure->rethrow();
    return report;
  } catch (const Interrupted&) {
    failure->rethrow();
    throw;
  }
}

Pair judge(const EnvConfig& environment, const PythonPolicy& policy, const StartRanges& starts_from,
           std::uint64_t seed, const std::vector<std::string>& engines, const JudgeOptions& options,
           const nb::object& progress) {
  refuse_stored_runs(options);
  return to_python(run_job(
      [=](const StageProgress& told) {
        return with_policies(
            {policy}, told, [&](const auto& policies, const StageProgress& listening) -> Report {
              const LoadedEnv loaded = environment;
              const Behaviour behaviour =
                  policy_behaviour(loaded, policies.front().make, policies.front().name, starts_from, seed);
              return report_of(
                  judge_engines(behaviour, EnvModel::make(loaded)->world, engines, options, listening),
                  provenance({{"python", policy.name}}, engines));
            });
      },
      progress));
}

void bind_verdicts(nb::module_& m) {
  nb::class_<StartRanges>(m, "StartRanges", "How far apart the starts of a verdict lie.")
      .def(
          "__init__",
          [](StartRanges* self, std::optional<double> position_m, double heading_rad,
             std::optional<double> push_mps) {
            new (self) StartRanges{position_m, heading_rad, StartRanges().tilt_rad, push_mps};
          },
          nb::kw_only(), nb::arg("position_m") = nb::none(),
          nb::arg("heading_rad") = StartRanges().heading_rad, nb::arg("push_mps") = nb::none())
      .def_ro("position_m", &StartRanges::position_m, "Each way along x and y; None: by the robot's size.")
      .def_ro("heading_rad", &StartRanges::heading_rad, "Each way.")
      .def_ro("push_mps", &StartRanges::push_mps,
              "The speed that one push would give to the robot; None: by its size.");
  m.def(
      "_judge_walk",
      [](const Subject& walk, const std::vector<std::string>& engines, const StartRanges& starts_from,
         std::uint64_t seed, std::size_t starts, double limit, double confidence, std::size_t workers,
         bool explain, const std::string& runs, const nb::object& progress) {
        const JudgeOptions options = judge_options(starts, limit, confidence, workers, explain, runs);
        if (const auto* config = std::get_if<WalkConfig>(&walk))
          return judge({*config, starts_from, seed}, engines, options, progress);
        return judge(std::get<PythonController>(walk), starts_from, seed, engines, options, progress);
      },
      nb::arg("walk"), nb::arg("engines"), nb::arg("starts_from"), nb::arg("seed"), nb::arg("starts"),
      nb::arg("limit"), nb::arg("confidence"), nb::arg("workers"), nb::arg("explain"), nb::arg("runs"),
      kProgress);
  m.def(
      "_judge_policy",
      [](const EnvConfig& environment, const PolicyChoice& policy, const std::vector<std::string>& engines,
         const StartRanges& starts_from, std::uint64_t seed, std::size_t starts, double limit,
         double confidence, std::size_t workers, bool explain, const std::string& runs,
         const nb::object& progress) {
        const JudgeOptions options = judge_options(starts, limit, confidence, workers, explain, runs);
        if (const auto* text = std::get_if<std::string>(&policy))
          return judge({PolicyConfig{environment, *text}, starts_from, seed}, engines, options, progress);
        return judge(environment, std::get<PythonPolicy>(policy), starts_from, seed, engines, options,
                     progress);
      },
      nb::arg("environment"), nb::arg("policy"), nb::arg("engines"), nb::arg("starts_from"), nb::arg("seed"),
      nb::arg("starts"), nb::arg("limit"), nb::arg("confidence"), nb::arg("workers"), nb::arg("explain"),
      nb::arg("runs"), kProgress);
}

Pair rollout(const EnvConfig& config, const std::vector<PolicyChoice>& choices, const EpisodeOptions& options,
             const nb::object& progress) {
  return to_python(run_job(
      [=](const StageProgress& told) {
        return with_policies(choices, told,
                             [&](const auto& policies, const StageProgress& listening) -> Report {
                               const Rollout result =
                                   roll_out(config, policies, options, progress_of(listening, "rolling out"));
                               if (result.interrupted) throw Interrupted();
                               return {to_json(result), describe(result)};
                             });
      },
      progress));
}

Pair transfer(const EnvConfig& config, const PolicyChoice& choice, const std::vector<std::string>& engines,
              const std::vector<std::string>& terrains, const EpisodeOptions& options,
              const nb::object& progress) {
  return to_python(run_job(
      [=](const StageProgress& told) {
        return with_policies(
            {choice}, told, [&](const auto& policies, const StageProgress& listening) -> Report {
              const Transfer result = transfer_policy(config, policies.front(), engines, terrains, options,
                                                      progress_of(listening, "transferring"));
              if (result.interrupted) throw Interrupted();
              return {to_json(result), describe(result)};
            });
      },
      progress));
}

Pair course(const EnvConfig& config, const PolicyChoice& choice, const std::string& name,
            const std::vector<std::string>& sections, const std::vector<std::string>& engines,
            const EpisodeOptions& options, const nb::object& progress) {
  return to_python(run_job(
      [=](const StageProgress& told) {
        return with_policies(
            {choice}, told, [&](const auto& policies, const StageProgress& listening) -> Report {
              const CourseResult result =
                  run_course(with_sections(load_course(name), sections), config, policies.front(), engines,
                             options, progress_of(listening, "on the course"));
              if (result.interrupted) throw Interrupted();
              return {to_json(result), describe(result)};
            });
      },
      progress));
}

Pair tune(const EnvConfig& config, const std::vector<std::string>& engines, const TuneOptions& options,
          const nb::object& progress) {
  const auto tuned = std::make_shared<EnvConfig>();
  const Report report = run_job(
      [=](const StageProgress& told) -> Report {
        const Tuning result = tune_gait(config, engines, options, progress_of(told, "tuning"));
        if (result.interrupted) throw Interrupted();
        *tuned = result.tuned;
        return {to_json(result), describe(result)};
      },
      progress);
  return nb::make_tuple(to_python(report), *tuned);
}

Pair bench(const std::vector<std::string>& engines, const std::vector<std::string>& sections, bool quick,
           const nb::object& progress) {
  return to_python(run_job(
      [=](const StageProgress& told) -> Report {
        const Json json = benchmarks::run_bench({engines, sections, quick}, progress_of(told, "measuring"));
        if (json.contains("interrupted")) throw Interrupted();
        return {json, benchmarks::describe_bench(json)};
      },
      progress));
}

Pair conformance_of(const std::string& engine, const std::vector<std::string>& only,
                    const nb::object& progress) {
  return to_python(run_job(
      [=](const StageProgress& told) -> Report {
        const conformance::Card card =
            conformance::check_engine(engine, only, progress_of(told, "checking " + engine));
        return {to_json(card), describe(card)};
      },
      progress));
}

}  // namespace

void bind_studies(nb::module_& m) {
  bind_walk_config(m);
  bind_behaviour(m);
  bind_python_policy(m);
  // Jobs whose callers were interrupted may still call into the interpreter.
  nb::module_::import_("atexit").attr("register")(nb::cpp_function(&Job::wait_for_leftovers));
  m.def("_walk", &walk_in, nb::arg("walk"), nb::arg("engine"), nb::arg("trace"), kProgress);
  m.def(
      "_compare",
      [](const Subject& walk, const std::vector<std::string>& engines, bool trace, double position,
         double joint, double attitude, const nb::object& progress) {
        DivergenceTolerances tolerances;
        tolerances.position = position;
        tolerances.joint = joint;
        tolerances.attitude = attitude;
        return compare_in(walk, engines, trace, tolerances, progress);
      },
      nb::arg("walk"), nb::arg("engines"), nb::arg("trace"), nb::arg("position"), nb::arg("joint"),
      nb::arg("attitude"), kProgress);
  bind_verdicts(m);
  m.def(
      "_rollout",
      [](const EnvConfig& config, const std::vector<PolicyChoice>& policies, std::size_t episodes,
         std::size_t workers, std::uint64_t seed, const nb::object& progress) {
        return rollout(config, policies, {episodes, workers, seed}, progress);
      },
      nb::arg("environment"), nb::arg("policies"), nb::arg("episodes"), nb::arg("workers"), nb::arg("seed"),
      kProgress);
  m.def(
      "_transfer",
      [](const EnvConfig& config, const PolicyChoice& policy, const std::vector<std::string>& engines,
         const std::vector<std::string>& terrains, std::size_t episodes, std::size_t workers,
         std::uint64_t seed, const nb::object& progress) {
        return transfer(config, policy, engines, terrains, {episodes, workers, seed}, progress);
      },
      nb::arg("environment"), nb::arg("policy"), nb::arg("engines"), nb::arg("terrains"), nb::arg("episodes"),
      nb::arg("workers"), nb::arg("seed"), kProgress);
  m.def(
      "_course",
      [](const EnvConfig& config, const PolicyChoice& policy, const std::string& name,
         const std::vector<std::string>& sections, const std::vector<std::string>& engines,
         std::size_t episodes, std::size_t workers, std::uint64_t seed, const nb::object& progress) {
        return course(config, policy, name, sections, engines, {episodes, workers, seed}, progress);
      },
      nb::arg("environment"), nb::arg("policy"), nb::arg("course"), nb::arg("sections"), nb::arg("engines"),
      nb::arg("episodes"), nb::arg("workers"), nb::arg("seed"), kProgress);
  m.def(
      "course_sections",
      [](const std::string& course) {
        std::vector<std::string> names;
        for (const CourseSection& section : load_course(course).sections) names.push_back(section.name);
        return names;
      },
      nb::arg("course"), "Names of a course's sections. Raises ConfigError for one that cannot be read.");
  m.def(
      "_tune",
      [](const EnvConfig& config, const std::vector<std::string>& engines, std::size_t iterations,
         std::size_t population, std::size_t terrains, std::size_t unseen, std::size_t workers,
         std::uint64_t seed, const std::optional<std::string>& course, const nb::object& progress) {
        TuneOptions options{iterations, population, terrains, unseen, workers, seed};
        if (course) options.course = load_course(*course);
        return tune(config, engines, options, progress);
      },
      nb::arg("environment"), nb::arg("engines"), nb::arg("iterations"), nb::arg("population"),
      nb::arg("terrains"), nb::arg("unseen"), nb::arg("workers"), nb::arg("seed"), nb::arg("course").none(),
      kProgress);
  m.def("_conformance", &conformance_of, nb::arg("engine"), nb::arg("only"), kProgress);
  m.def("_bench", &bench, nb::arg("engines"), nb::arg("sections"), nb::arg("quick"), kProgress);
}

}  // namespace crossgait::python
