// crossgait._core: the C++ core as Python sees it.
#include <nanobind/stl/string.h>

#include "python/bindings/bindings.h"
#include "study/version.h"

NB_MODULE(_core, m) {
  using namespace crossgait::python;
  m.doc() = "The C++ core of Crossgait. Use the package crossgait, which gives these names.";
  m.def(
      "version", [] { return std::string(crossgait::crossgait_version()); }, "Version of Crossgait.");
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
