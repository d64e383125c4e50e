// Runs by their specification: their hash, and the line of a store that they become.
#include <algorithm>

#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "physics/core/error.h"
#include "physics/core/hash.h"
#include "physics/core/text.h"
#include "python/bindings/bindings.h"
#include "python/bindings/walk_config.h"
#include "study/run_maker.h"

namespace crossgait::python {
namespace {

std::vector<std::string> variation_names() {
  std::vector<std::string> names;
  for (const Variation& variation : variations()) names.emplace_back(variation.name);
  return names;
}

}  // namespace

void bind_run_spec(nb::module_& m) {
  m.def("_variations", &variation_names, "Names of the variations of a verdict; the first is nominal.");
  nb::class_<RunMaker>(m, "_RunMaker", "Runs of one behaviour, whose robot and files are read once.")
      .def_static(
          "of_walk",
          [](const PythonWalk& walk, const StartRanges& starts_from, std::uint64_t seed) {
            return new RunMaker(BehaviourSpec{walk, starts_from, seed});
          },
          nb::arg("walk"), nb::arg("starts_from"), nb::arg("seed"), nb::rv_policy::take_ownership)
      .def_static(
          "of_policy",
          [](const EnvConfig& environment, const std::string& policy, const StartRanges& starts_from,
             std::uint64_t seed) {
            return new RunMaker(BehaviourSpec{PolicyConfig{environment, policy}, starts_from, seed});
          },
          nb::arg("environment"), nb::arg("policy"), nb::arg("starts_from"), nb::arg("seed"),
          nb::rv_policy::take_ownership)
      .def(
          "describe",
          [](const RunMaker& r, const std::string& engine, const std::string& variation, std::size_t start) {
            const std::string json = r.describe(engine, find_variation(variation), start).dump();
            return std::pair(fnv1a_hex(json), json);
          },
          nb::arg("engine"), nb::arg("variation"), nb::arg("start"),
          "Hash and canonical JSON of a run. Raises ConfigError.")
      .def(
          "allows",
          [](const RunMaker& r, const std::string& engine, const std::string& variation) {
            return r.allows(engine, find_variation(variation));
          },
          nb::arg("engine"), nb::arg("variation"),
          "Whether it keeps time steps whole, and concerns the engine. Raises ConfigError.")
      .def(
          "make",
          [](const RunMaker& r, const std::string& engine, const std::string& variation, std::size_t start) {
            return r.make(engine, find_variation(variation), start);
          },
          nb::arg("engine"), nb::arg("variation"), nb::arg("start"), nb::call_guard<nb::gil_scoped_release>(),
          "Makes the run, and returns its line of a store of runs. Raises ConfigError.");
}

}  // namespace crossgait::python
