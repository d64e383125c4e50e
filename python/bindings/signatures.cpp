// Where Python looks for signatures, on nanobind's own types of functions (crossgait/signatures.py).
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "python/bindings/bindings.h"

namespace crossgait::python {

void bind_signatures(nb::module_& m) {
  m.def(
      "_set_attribute_of_type",
      [](const nb::type_object& type, const std::string& name, const nb::object& value) {
        auto* immutable = reinterpret_cast<PyTypeObject*>(type.ptr());
        if (PyDict_SetItemString(immutable->tp_dict, name.c_str(), value.ptr()) != 0)
          throw nb::python_error();
        PyType_Modified(immutable);
      },
      nb::arg("type"), nb::arg("name"), nb::arg("value"),
      "Sets it also where `setattr` refuses: nanobind's types are immutable from Python.");
}

}  // namespace crossgait::python
