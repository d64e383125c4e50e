// ConfigError becomes crossgait.errors.ConfigError, a ValueError with the same four parts.
#include <exception>

#include "physics/core/error.h"
#include "physics/core/progress.h"
#include "python/bindings/bindings.h"

namespace crossgait::python {
namespace {

// Bytes that are no UTF-8 (names of files may hold any) as \xNN.
nb::object text(const std::string& bytes) {
  return nb::steal(
      PyUnicode_DecodeUTF8(bytes.data(), static_cast<Py_ssize_t>(bytes.size()), "backslashreplace"));
}

void translate(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const ConfigError& error) {
    const nb::object type = nb::module_::import_("crossgait.errors").attr("ConfigError");
    const nb::object value =
        type(text(error.source()), text(error.element()), text(error.expected()), text(error.found()));
    PyErr_SetObject(type.ptr(), value.ptr());
  } catch (const Interrupted&) {
    // What a handler of Python's raised, where one was asked.
    if (PyErr_Occurred() == nullptr) PyErr_SetNone(PyExc_KeyboardInterrupt);
  }
}

}  // namespace

void bind_errors(nb::module_&) { nb::register_exception_translator(translate); }

}  // namespace crossgait::python
