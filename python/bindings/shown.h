// Values of Python's in messages.
#pragma once

#include <string>

#include <nanobind/nanobind.h>

namespace crossgait::python {

/// Returns what `repr` says of a value, whatever it says: its beginning where it is long, in ASCII where
/// UTF-8 has no bytes for it (halves of surrogate pairs), the type's name where it raises.
inline std::string shown(nanobind::handle value) {
  namespace nb = nanobind;
  constexpr std::size_t kLongest = 1000;
  for (PyObject* (*const say)(PyObject*) : {PyObject_Repr, PyObject_ASCII}) {
    const nb::object text = nb::steal(say(value.ptr()));
    Py_ssize_t size = 0;
    const char* bytes = text.is_valid() ? PyUnicode_AsUTF8AndSize(text.ptr(), &size) : nullptr;
    if (bytes == nullptr) {
      PyErr_Clear();
      continue;
    }
    std::string said(bytes, static_cast<std::size_t>(size));
    if (said.size() <= kLongest) return said;
    std::size_t end = kLongest;
    while ((static_cast<unsigned char>(said[end]) & 0xC0U) == 0x80U) --end;  // not within a character
    return said.substr(0, end) + "...";
  }
  return Py_TYPE(value.ptr())->tp_name;
}

}  // namespace crossgait::python
