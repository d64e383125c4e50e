// The parts of the extension module, a function each. What they bind is documented in the headers of the core
// and, for people who write Python, in the docstrings.
#pragma once

#include <nanobind/nanobind.h>

namespace crossgait::python {

namespace nb = nanobind;

void bind_errors(nb::module_& m);
void bind_engines(nb::module_& m);
void bind_robot(nb::module_& m);
void bind_terrain(nb::module_& m);
void bind_contacts(nb::module_& m);
void bind_world(nb::module_& m);
void bind_kinematics(nb::module_& m);
void bind_gait(nb::module_& m);
void bind_batch(nb::module_& m);
void bind_environment_config(nb::module_& m);
void bind_number(nb::module_& m);
void bind_environment(nb::module_& m);
void bind_vector_environment(nb::module_& m);
void bind_policy(nb::module_& m);
void bind_studies(nb::module_& m);
void bind_diagnosis(nb::module_& m);
void bind_run_spec(nb::module_& m);
void bind_trace_file(nb::module_& m);
void bind_files_read(nb::module_& m);
void bind_signatures(nb::module_& m);

/// Lets every function and class of the module say which argument does not fit. @throws std::logic_error if
/// nanobind calls its functions in more ways than six
void tell_errors_of_calls(const nb::module_& m);

}  // namespace crossgait::python
