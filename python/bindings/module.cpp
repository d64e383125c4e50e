// crossgait._core: the C++ core as Python sees it.
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>

#include "physics/core/consent.h"
#include "physics/core/python_program.h"
#include "python/bindings/bindings.h"
#include "study/version.h"

NB_MODULE(_core, m) {
  using namespace crossgait::python;
  m.doc() = "The C++ core of Crossgait. Use the package crossgait, which gives these names.";
  m.def(
      "version", [] { return std::string(crossgait::crossgait_version()); }, "Version of Crossgait.");
  crossgait::set_python_program(nb::cast<std::string>(nb::module_::import_("sys").attr("executable")));
  m.def("require_consent", &crossgait::require_consent, nb::arg("file"), nb::arg("runs"),
        "Say that a file runs code. Raises ConfigError unless it is the user's own or trusted.");
  m.def("trust_folder", &crossgait::trust_folder, nb::arg("folder"), nb::arg("source"),
        "Trust the files of a folder in this process and those that it begins.");
  m.def("trusted_folders", &crossgait::trusted_folders, "Folders whose files may run code, apart by colons.");
  m.attr("TRUST_VARIABLE") = crossgait::kTrustVariable;
  bind_errors(m);
  bind_engines(m);
  bind_robot(m);
  bind_terrain(m);
  bind_world(m);
  bind_environment_config(m);
  bind_batch(m);
  bind_environment(m);
  bind_vector_environment(m);
  bind_policy(m);
  bind_studies(m);
  bind_diagnosis(m);
  bind_run_spec(m);
  bind_kinematics(m);
  bind_gait(m);  // of the walks of studies
}
