// A diagnosis as a function: what it returns is what `--json` writes, without the provenance of a command
// line.
#include "diagnosis/diagnosis.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "python/bindings/bindings.h"
#include "python/bindings/job.h"
#include "python/bindings/study_report.h"

namespace crossgait::python {
namespace {

Pair diagnose_policy(const EnvConfig& config, const std::string& policy, const DiagnosisOptions& options,
                     const nb::object& progress) {
  const auto environment = std::make_shared<EnvConfig>();
  const Report report = run_job(
      [=](const StageProgress& told) -> Report {
        const Diagnosis found = diagnose(config, policy, options, progress_of(told, "diagnosing"));
        *environment = found.environment;
        return {to_json(found), describe(found)};
      },
      progress);
  return nb::make_tuple(to_python(report), *environment);
}

}  // namespace

void bind_diagnosis(nb::module_& m) {
  m.def(
      "_diagnose",
      [](const EnvConfig& config, const std::string& policy, const std::vector<std::string>& unstated,
         const std::optional<std::string>& home_engine, bool search, std::size_t workers, std::uint64_t seed,
         const nb::object& progress) {
        return diagnose_policy(config, policy, {workers, seed, unstated, home_engine, search}, progress);
      },
      nb::arg("environment"), nb::arg("policy"), nb::arg("unstated"), nb::arg("home_engine").none(),
      nb::arg("search"), nb::arg("workers"), nb::arg("seed"), kProgress);
}

}  // namespace crossgait::python
