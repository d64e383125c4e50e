// Calls whose arguments do not fit say which of them, and what was expected (crossgait/signatures.py).
//
// nanobind's own error lists the signatures. Its functions keep the address of what calls them where Python's
// vectorcall protocol (PEP 590) has it: there stands one of ours, which calls nanobind's and says its error
// in other words. A call that fits takes a jump more.
#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <nanobind/nanobind.h>
#include <nanobind/stl/string_view.h>

#include "python/bindings/bindings.h"

namespace crossgait::python {
namespace {

// nanobind has one for every way to take arguments, six in all.
constexpr std::size_t kMostCallers = 12;
std::array<vectorcallfunc, kMostCallers> callers{};

// The upper bits of a count say something else.
constexpr std::size_t kCountBits = SIZE_MAX >> 8;

/// Takes the error that is set, if it is one about arguments. @returns whether it was
bool take_error_of_arguments(nb::object& error) {
  if (PyErr_ExceptionMatches(PyExc_TypeError) == 0) return false;
  PyObject *type = nullptr, *value = nullptr, *trace = nullptr;
  PyErr_Fetch(&type, &value, &trace);
  PyErr_NormalizeException(&type, &value, &trace);
  const nb::str text{nb::handle(value)};
  if (std::string_view(text.c_str()).find("(): incompatible function arguments") == std::string_view::npos) {
    PyErr_Restore(type, value, trace);
    return false;
  }
  error = nb::steal(value);
  Py_XDECREF(type);
  Py_XDECREF(trace);
  return true;
}

void say_what_did_not_fit(PyObject* function, PyObject* const* given, std::size_t count, PyObject* names) {
  nb::object error;
  if (!take_error_of_arguments(error)) return;
  try {
    const auto name = nb::cast<std::string_view>(nb::handle(function).attr("__name__"));
    // What a constructor is handed first is not made yet.
    const std::size_t begin = name == "__init__" || name == "__new__" ? 1 : 0;
    nb::list positional;
    for (std::size_t i = begin; i < count; ++i) positional.append(nb::handle(given[i]));
    nb::dict keywords;
    const Py_ssize_t named = names == nullptr ? 0 : PyTuple_GET_SIZE(names);
    for (Py_ssize_t i = 0; i < named; ++i)
      keywords[nb::handle(PyTuple_GET_ITEM(names, i))] =
          nb::handle(given[count + static_cast<std::size_t>(i)]);
    const nb::object said = nb::module_::import_("crossgait.signatures")
                                .attr("misfit")(nb::handle(function), positional, keywords);
    PyErr_SetObject(PyExc_TypeError, said.ptr());
  } catch (nb::python_error&) {
    PyErr_SetObject(PyExc_TypeError, error.ptr());
  }
}

template <std::size_t k>
PyObject* call(PyObject* function, PyObject* const* given, std::size_t count, PyObject* names) {
  PyObject* result = callers[k](function, given, count, names);
  if (result == nullptr) say_what_did_not_fit(function, given, count & kCountBits, names);
  return result;
}

template <std::size_t... k>
constexpr std::array<vectorcallfunc, sizeof...(k)> calls_of(std::index_sequence<k...>) {
  return {call<k>...};
}
constexpr auto kCalls = calls_of(std::make_index_sequence<kMostCallers>());

bool is_nanobinds(nb::handle function) {
  const std::string_view type = Py_TYPE(function.ptr())->tp_name;
  return type.ends_with(".nb_func") || type.ends_with(".nb_method");
}

void tell_errors_of(nb::handle function) {
  if (!is_nanobinds(function)) return;
  auto* bytes = reinterpret_cast<char*>(function.ptr()) + Py_TYPE(function.ptr())->tp_vectorcall_offset;
  auto& caller = *reinterpret_cast<vectorcallfunc*>(bytes);
  if (std::find(kCalls.begin(), kCalls.end(), caller) != kCalls.end()) return;
  auto slot = std::find(callers.begin(), callers.end(), caller);
  if (slot == callers.end()) slot = std::find(callers.begin(), callers.end(), nullptr);
  if (slot == callers.end()) throw std::logic_error("nanobind has more ways to call than were known");
  *slot = caller;
  caller = kCalls[static_cast<std::size_t>(slot - callers.begin())];
}

}  // namespace

void tell_errors_of_calls(const nb::module_& m) {
  for (const auto [name, value] : nb::borrow<nb::dict>(m.attr("__dict__"))) {
    tell_errors_of(value);
    if (!nb::type_check(value)) continue;
    const nb::object members = value.attr("__dict__").attr("values")();
    for (const nb::handle of_class : members) {
      tell_errors_of(of_class);
      if (nb::hasattr(of_class, "fset")) tell_errors_of(nb::object(of_class.attr("fset")));
    }
  }
}

}  // namespace crossgait::python
