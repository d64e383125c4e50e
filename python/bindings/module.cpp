// crossgait._core: the C++ core as Python sees it.
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>

#include "physics/core/consent.h"
#include "physics/core/python_program.h"
#include "physics/core/schema.h"
#include "physics/core/worker_pool.h"
#include "python/bindings/bindings.h"
#include "study/version.h"

namespace {

namespace nb = nanobind;

bool is_loaded = false;

/// Makes an object as `type(...)` does. Python's own slot does the same, but lets `object.__new__` by, whose
/// objects nanobind has never seen; of a type with another slot `object.__new__` raises TypeError.
PyObject* made_by_new(PyTypeObject* type, PyObject* arguments, PyObject* keywords) {
  const nb::object make = nb::steal(PyObject_GetAttrString(reinterpret_cast<PyObject*>(type), "__new__"));
  const nb::object given = nb::steal(PyTuple_New(PyTuple_GET_SIZE(arguments) + 1));
  if (!make.is_valid() || !given.is_valid()) return nullptr;
  PyTuple_SET_ITEM(given.ptr(), 0, nb::borrow(reinterpret_cast<PyObject*>(type)).release().ptr());
  for (Py_ssize_t i = 0; i < PyTuple_GET_SIZE(arguments); ++i)
    PyTuple_SET_ITEM(given.ptr(), i + 1, nb::borrow(PyTuple_GET_ITEM(arguments, i)).release().ptr());
  return PyObject_Call(make.ptr(), given.ptr(), keywords);
}

/// Of every class of the module that is made by a `__new__` of its own (nb::new_).
void refuse_bare_objects(const nb::module_& m) {
  for (const auto [name, value] : nb::borrow<nb::dict>(m.attr("__dict__"))) {
    // That of nanobind is a function of Python's own, which looks after itself.
    if (nb::type_check(value) && !PyCFunction_Check(nb::object(value.attr("__new__")).ptr()))
      reinterpret_cast<PyTypeObject*>(value.ptr())->tp_new = made_by_new;
  }
}

/// Sets an ImportError where the core cannot be loaded. @returns whether it can
bool may_load() {
  if (PyInterpreterState_Get() != PyInterpreterState_Main()) {
    PyErr_SetString(
        PyExc_ImportError,
        "crossgait runs in the main interpreter alone: expected no sub-interpreter; use a process");
    return false;
  }
  if (is_loaded) {
    PyErr_SetString(PyExc_ImportError,
                    "crossgait._core is loaded already, and loads once in a process: begin a new one");
    return false;
  }
  return true;
}

}  // namespace

// What nanobind makes to load the module; before it anything runs, it is asked whether it may.
NB_MODULE(crossgait_core, m) {
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
  m.attr("MOST_WORKERS") = crossgait::kMaxWorkers;
  m.attr("SCHEMA_VERSION") = crossgait::schema("walk").at("version").get<std::string>();
  bind_errors(m);
  bind_engines(m);
  bind_robot(m);
  bind_terrain(m);
  bind_world(m);
  bind_environment_config(m);
  bind_number(m);
  bind_batch(m);
  bind_environment(m);
  bind_vector_environment(m);
  bind_policy(m);
  bind_studies(m);
  bind_diagnosis(m);
  bind_run_spec(m);
  bind_trace_file(m);
  bind_files_read(m);
  bind_signatures(m);
  bind_kinematics(m);
  bind_gait(m);  // of the walks of studies
  refuse_bare_objects(m);
  tell_errors_of_calls(m);
  is_loaded = true;
}

extern "C" NB_EXPORT PyObject* PyInit__core() { return may_load() ? PyInit_crossgait_core() : nullptr; }
