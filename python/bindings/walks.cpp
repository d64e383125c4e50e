// `crossgait walk` and `compare` as functions, with traces.
#include <algorithm>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "backends/registry.h"
#include "parity/report.h"
#include "python/bindings/arrays.h"
#include "python/bindings/job.h"
#include "python/bindings/study_report.h"
#include "study/walk.h"

namespace crossgait::python {
namespace {

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

}  // namespace

void bind_walk_studies(nb::module_& m) {
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
}

}  // namespace crossgait::python
