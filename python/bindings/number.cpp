#include "python/bindings/number.h"

#include <string>

#include <nanobind/stl/string.h>

#include "python/bindings/bindings.h"

namespace crossgait::python {

nb::object as_written(nb::handle numbers) {
  const nb::object dtype = nb::getattr(numbers, "dtype", nb::none());
  const nb::object kind = nb::getattr(dtype, "kind", nb::none());  // which other libraries' have not
  if (!nb::isinstance<nb::str>(kind) || nb::cast<std::string>(kind) != "f" ||
      nb::cast<int>(dtype.attr("itemsize")) == 8)
    return nb::borrow(numbers);
  if (nb::cast<int>(dtype.attr("itemsize")) > 8) return numbers.attr("astype")("float64");
  return numbers.attr("astype")("str").attr("astype")("float64");
}

void bind_number(nb::module_& m) {
  m.def("_as_written", &as_written, nb::arg("numbers"),
        nb::sig("def _as_written(numbers: typing.Any) -> typing.Any"),
        "NumPy's numbers, those of fewer digits than Python's as they were written.");
}

}  // namespace crossgait::python
