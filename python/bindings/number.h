// A number that a caller wrote, in any of Python's and NumPy's types.
#pragma once

#include <nanobind/nanobind.h>

namespace crossgait::python {

/// NumPy's numbers of fewer digits than Python's have those that they were written with: 0.02 of float32 is
/// 0.02. Those of more become Python's. Other objects come back as they are.
nanobind::object as_written(nanobind::handle numbers);

/// Is taken wherever a float is, as it was written.
struct WrittenNumber {
  double value = 0;

  operator double() const noexcept { return value; }
};

}  // namespace crossgait::python

namespace nanobind::detail {

template <>
struct type_caster<crossgait::python::WrittenNumber> {
  NB_TYPE_CASTER(crossgait::python::WrittenNumber, const_name("float"))

  bool from_python(handle source, std::uint8_t flags, cleanup_list* cleanup) noexcept {
    try {
      const object written = crossgait::python::as_written(source);
      make_caster<double> number;
      if (!number.from_python(written, flags, cleanup)) return false;
      value.value = number.value;
      return true;
    } catch (python_error&) {  // of an object that only looks like NumPy's
      return false;
    }
  }
  static handle from_cpp(crossgait::python::WrittenNumber number, rv_policy, cleanup_list*) noexcept {
    return PyFloat_FromDouble(number.value);
  }
};

}  // namespace nanobind::detail
