// What studies return to Python, and what they are made of.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <nanobind/nanobind.h>
#include <nlohmann/json.hpp>

#include "python/bindings/behaviour.h"
#include "python/bindings/python_policy.h"
#include "study/loaded_walk.h"

namespace crossgait::python {

using Json = nlohmann::ordered_json;
using Pair = nb::typed<nb::tuple, nb::any, nb::any>;

/// A function of a stage and a share, or None.
const auto kProgress = nb::arg("progress").none();

/// Holds a result as JSON and as the table that a command prints.
struct Report {
  Json json;
  std::string text;
};

/// Makes the document and the text of it.
Pair to_python(const Report& report);

/// Says where a result comes from. To be called in the job that made it: it names the files that the job has
/// read. @throws ConfigError
Json provenance(const nlohmann::json& subject, const std::vector<std::string>& engines);

/// Says what a walk is made of, for whoever wants to make it again. Of a function in Python there is only its
/// name.
nlohmann::json subject_json(const Subject& subject, const LoadedWalk& loaded);

/// Calls `work(policies, progress)`, and throws what a policy in Python raised, if one did.
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

void bind_walk_studies(nb::module_& m);
void bind_verdicts(nb::module_& m);

}  // namespace crossgait::python
