// Classes whose objects come from functions: what making one by its name says.
#pragma once

#include <nanobind/nanobind.h>

namespace crossgait::python {

/// The constructor of a class of which there is none: raises TypeError that says where its objects come from.
template <typename T>
auto not_made(const char* where) {
  return [where](T* /*self*/, const nanobind::args& /*any*/, const nanobind::kwargs& /*keywords*/) {
    throw nanobind::type_error(where);
  };
}
inline constexpr const char* kNotMade = "def __init__(self) -> None";

}  // namespace crossgait::python
