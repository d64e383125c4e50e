#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "backends/registry.h"
#include "python/bindings/bindings.h"
#include "python/bindings/not_made.h"

namespace crossgait::python {
namespace {

nb::dict laws(const EngineInfo& info) {
  nb::dict result;
  result["contact"] = info.laws.contact;
  result["loops"] = info.laws.loops;
  result["joint_friction"] = info.laws.joint_friction;
  result["joint_limits"] = info.laws.joint_limits;
  result["couplings"] = info.laws.couplings;
  result["implicit_servos"] = info.laws.implicit_servos;
  result["contact_family"] = info.laws.contact_family;
  return result;
}

}  // namespace

void bind_engines(nb::module_& m) {
  nb::class_<EngineListing>(m, "Engine", "A physics engine in one mode, by the name that it is chosen by.")
      .def("__init__", not_made<EngineListing>("engines are those of crossgait.engines()"), nb::sig(kNotMade))
      .def_ro("name", &EngineListing::name, "What other functions take as `engine`.")
      .def_ro("summary", &EngineListing::summary)
      .def_ro("available", &EngineListing::available, "Whether worlds can be made in it here.")
      .def_ro("reason", &EngineListing::reason, "Why not, where not.")
      .def_prop_ro(
          "library", [](const EngineListing& e) { return e.info.library; }, "Name of its library.")
      .def_prop_ro(
          "version", [](const EngineListing& e) { return e.info.version; }, "Version of its library.")
      .def_prop_ro(
          "mode", [](const EngineListing& e) { return e.info.mode; }, "Its contact mode in words.")
      .def_prop_ro(
          "precision",
          [](const EngineListing& e) { return std::string(name_of(e.info.capabilities.precision)); },
          "float64 or float32: what it computes in.")
      .def_prop_ro(
          "laws", [](const EngineListing& e) { return laws(e.info); },
          nb::sig("def laws(self) -> dict[str, str]"),
          "The laws that it solves: engines that agree in all of them solve the same equations.")
      .def("__repr__",
           [](const EngineListing& e) {
             return "<crossgait.Engine '" + e.name + "': " + (e.available ? e.info.mode : e.reason) + ">";
           })
      .def("__reduce__", [](const EngineListing& e) {
        return nb::make_tuple(nb::module_::import_("crossgait.inputs").attr("engine_called"),
                              nb::make_tuple(e.name));
      });
  m.def("engines", &known_engines,
        "Every engine that Crossgait knows, available or not; the first is the default.");
  m.def("available_engines", &available_engines,
        "Names of those that are available. The first is the default.");
}

}  // namespace crossgait::python
