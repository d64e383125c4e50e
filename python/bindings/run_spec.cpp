// Runs by their specification: their hash, and the line of a store that they become.
#include <algorithm>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include "physics/core/error.h"
#include "physics/core/hash.h"
#include "physics/core/text.h"
#include "python/bindings/bindings.h"
#include "python/bindings/walk_config.h"
#include "study/run_maker.h"
#include "study/run_store.h"

namespace crossgait::python {
namespace {

std::vector<std::string> variation_names() {
  std::vector<std::string> names;
  for (const Variation& variation : variations()) names.emplace_back(variation.name);
  return names;
}

/// A store that is closed when Python says so.
struct OpenStore {
  std::unique_ptr<RunStore> store;

  RunStore& get(const char* doing) const {
    if (!store) throw ConfigError("run store", doing, "an open one", "one that was closed");
    return *store;
  }
};

void bind_store(nb::module_& m) {
  nb::class_<OpenStore>(m, "_RunStore", "A file of runs while it is written, as verdicts write it.")
      .def(
          "__init__",
          [](OpenStore* self, const std::string& path) {
            const nb::gil_scoped_release release;
            new (self) OpenStore{std::make_unique<RunStore>(path)};
          },
          nb::arg("path"), "Takes its lock. Raises ConfigError.")
      .def(
          "has_failed",
          [](const OpenStore& self, std::string_view hash) {
            const RunStore& store = self.get("has_failed");
            const std::optional<std::uint64_t> number = parse_run_hash(hash);
            return number ? store.has_failed(*number) : std::nullopt;
          },
          nb::arg("hash"), "Whether the run failed; None where no row is of it.")
      .def(
          "add", [](OpenStore& self, const std::string& row) { self.get("add").add_row(row); },
          nb::arg("row"), "Appends a row. Raises ConfigError.")
      .def("sync", [](OpenStore& self) { self.get("sync").sync(); })
      .def(
          "check_place", [](const OpenStore& self) { self.get("check_place").check_place(); },
          "Raises ConfigError if the file was removed or replaced.")
      .def(
          "close", [](OpenStore& self) { self.store.reset(); }, "Lets go of the lock.");
  m.def(
      "_check_row",
      [](const nb::bytes& line, const std::string& path, std::size_t number) {
        read_stored_row({line.c_str(), line.size()}, path, number);
      },
      nb::arg("line"), nb::arg("path"), nb::arg("number"), "Raises ConfigError for what is no stored run.");
  m.def(
      "_is_torn_row",
      [](const nb::bytes& line, bool has_rows_before) {
        return is_torn_row({line.c_str(), line.size()}, has_rows_before);
      },
      nb::arg("line"), nb::arg("has_rows_before"),
      "Whether a last line is what a writer leaves that is stopped on its way.");
}

}  // namespace

void bind_run_spec(nb::module_& m) {
  bind_store(m);
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
