// Episodes and measurements as functions: what they return is what `--json` writes, without the provenance of
// a command line.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "benchmarks/bench.h"
#include "conformance/card.h"
#include "python/bindings/behaviour.h"
#include "python/bindings/bindings.h"
#include "python/bindings/job.h"
#include "python/bindings/python_policy.h"
#include "python/bindings/study_report.h"
#include "python/bindings/trace_numbers.h"
#include "python/bindings/walk_config.h"
#include "study/course.h"
#include "study/provenance.h"
#include "study/rollout.h"
#include "study/tune.h"

namespace crossgait::python {
namespace {

// With traces of every policy's first episode, if they are asked for: made anew, as they come alike.
Pair rollout(const EnvConfig& config, const std::vector<PolicyChoice>& choices, const EpisodeOptions& options,
             bool trace, const nb::object& progress) {
  const auto kept = std::make_shared<std::vector<TraceNumbers>>();
  const Report report = run_job(
      [=](const StageProgress& told) {
        return with_policies(choices, told,
                             [&](const auto& policies, const StageProgress& listening) -> Report {
                               const LoadedEnv loaded = config;
                               const Rollout result =
                                   roll_out(loaded, policies, options, progress_of(listening, "rolling out"));
                               if (result.interrupted) throw Interrupted();
                               if (trace) kept->resize(policies.size(), TraceNumbers(loaded.robot));
                               for (std::size_t i = 0; i < kept->size(); ++i)
                                 record_episode(loaded, policies[i], options.seed, (*kept)[i]);
                               return {to_json(result), describe(result)};
                             });
      },
      progress);
  return nb::make_tuple(to_python(report), to_python(kept));
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
  bind_walk_studies(m);
  bind_verdicts(m);
  m.def(
      "_rollout",
      [](const EnvConfig& config, const std::vector<PolicyChoice>& policies, std::size_t episodes,
         std::size_t workers, std::uint64_t seed, bool trace, const nb::object& progress) {
        return rollout(config, policies, {episodes, workers, seed}, trace, progress);
      },
      nb::arg("environment"), nb::arg("policies"), nb::arg("episodes"), nb::arg("workers"), nb::arg("seed"),
      nb::arg("trace"), kProgress);
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
  m.def(
      "_read_result_text", [](const std::string& file) { return read_result_text(file); }, nb::arg("file"),
      "Of a JSON object that says each key once.");
  m.def("_conformance", &conformance_of, nb::arg("engine"), nb::arg("only"), kProgress);
  m.def("_bench", &bench, nb::arg("engines"), nb::arg("sections"), nb::arg("quick"), kProgress);
}

}  // namespace crossgait::python
