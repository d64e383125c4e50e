#include "python/bindings/study_report.h"

#include <utility>

#include <nanobind/stl/string.h>

#include "backends/registry.h"
#include "python/bindings/json.h"
#include "study/provenance.h"
#include "study/run_spec.h"

namespace crossgait::python {

Pair to_python(const Report& report) { return nb::make_tuple(python::to_python(report.json), report.text); }

Json provenance(const nlohmann::json& subject, const std::vector<std::string>& engines) {
  Provenance made;
  made.command = "python";
  made.subject = subject;
  for (const std::string& name : engines) made.engines.push_back(find_engine(name).info);
  return to_json(with_files_read(std::move(made)));
}

nlohmann::json subject_json(const Subject& subject, const LoadedWalk& loaded) {
  if (std::holds_alternative<PythonWalk>(subject))
    return {{"behaviour", LoadedBehaviour(loaded, {}, 0).described.at("behaviour")}};
  return {{"python", std::get<PythonController>(subject).name}};
}

}  // namespace crossgait::python
