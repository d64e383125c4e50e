// Diagnoses and scores as functions: what they return is what `--json` writes, without the provenance of a
// command line.
#include "diagnosis/diagnosis.h"

#include "diagnosis/import_table.h"
#include "diagnosis/joint_orders.h"
#include "diagnosis/policy_score.h"
#include "diagnosis/transfer_matrix.h"
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "python/bindings/bindings.h"
#include "python/bindings/job.h"
#include "python/bindings/robot.h"
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

// Name, home, environment and file of a policy.
using Scored = std::tuple<std::string, std::string, EnvConfig, std::string>;

Pair score(const std::vector<Scored>& policies, const std::vector<std::string>& engines,
           const PolicyScoreOptions& options, bool as_matrix, const nb::object& progress) {
  return to_python(run_job(
      [=](const StageProgress& told) -> Report {
        std::vector<ScoredPolicy> read;
        for (const auto& [name, home, environment, file] : policies)
          read.push_back({name, home, environment, read_relabelled_policy(file)});
        const auto cells = score_policies(read, engines, options, progress_of(told, "scoring"));
        if (!as_matrix) return {to_json(cells, options), describe(cells)};
        const TransferMatrix matrix = transfer_matrix(cells);
        return {to_json(matrix, cells, options), describe(matrix, cells)};
      },
      progress));
}

// The servos in the order of every convention, by its name.
nb::dict orders_of(const Robot& robot) {
  const std::vector<ServoPlace> servos = servo_places(*robot.description);
  nb::dict orders;
  for (const JointOrder& order : joint_orders())
    orders[nb::str(order.name.data(), order.name.size())] = nb::cast(joints_in_order(order, servos));
  return orders;
}

}  // namespace

void bind_diagnosis(nb::module_& m) {
  m.def("joint_orders", &orders_of, nb::arg("robot"),
        nb::sig("def joint_orders(robot: Robot) -> dict[str, list[str]]"),
        "The robot's servos in the order of every convention that files mean without saying so, by its name "
        "(docs/importing.md).");
  m.def(
      "_diagnose",
      [](const EnvConfig& config, const std::string& policy, const std::vector<std::string>& unstated,
         const std::optional<std::string>& home_engine, bool search, std::size_t workers, std::uint64_t seed,
         double minutes, const nb::object& progress) {
        return diagnose_policy(config, policy, {workers, seed, unstated, home_engine, search, minutes},
                               progress);
      },
      nb::arg("environment"), nb::arg("policy"), nb::arg("unstated"), nb::arg("home_engine").none(),
      nb::arg("search"), nb::arg("workers"), nb::arg("seed"), nb::arg("minutes"), kProgress);
  m.def("_is_imported", &is_imported, nb::arg("policy"));
  m.def(
      "_score",
      [](const std::vector<Scored>& policies, const std::vector<std::string>& engines, std::size_t starts,
         double seconds, std::uint64_t seed, std::size_t workers, bool as_matrix,
         const nb::object& progress) {
        return score(policies, engines, {starts, seconds, seed, workers}, as_matrix, progress);
      },
      nb::arg("policies"), nb::arg("engines"), nb::arg("starts"), nb::arg("seconds"), nb::arg("seed"),
      nb::arg("workers"), nb::arg("as_matrix"), kProgress);
}

}  // namespace crossgait::python
