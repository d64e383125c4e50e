// NumPy arrays in and out.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <Eigen/Core>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "physics/core/error.h"
#include "python/bindings/shown.h"

namespace crossgait::python {

namespace nb = nanobind;

/// Array that functions take: float64 or float32, of any shape, in C order.
using AnyArray = nb::ndarray<nb::ro, nb::c_contig, nb::device::cpu>;

/// Holds numpy.empty, and types that it is asked for; found once, they live as long as the process.
struct NumpyEmpty {
  nb::handle empty = nb::module_::import_("numpy").attr("empty").inc_ref();
  nb::handle bool_type = nb::module_::import_("numpy").attr("bool_").inc_ref();
  nb::handle int64_type = nb::module_::import_("numpy").attr("int64").inc_ref();
  nb::handle float_type = nb::module_::import_("builtins").attr("float").inc_ref();
  nb::handle object_type = nb::module_::import_("builtins").attr("object").inc_ref();

  static const NumpyEmpty& get() {
    static const auto* found = new NumpyEmpty;
    return *found;
  }
};

/// Is a new array of NumPy's, whose numbers are left as they come, and where they are. NumPy makes it: a step
/// of an environment needs several, and nanobind's way to one (capsule, DLPack, numpy.array) takes longer.
template <typename T>
struct NewArray {
  T* data;
  nb::object array;

  explicit NewArray(std::size_t size) : NewArray(nb::cast(size)) {}
  NewArray(std::size_t rows, std::size_t columns) : NewArray(nb::make_tuple(rows, columns)) {}

 private:
  explicit NewArray(const nb::object& shape) : array(empty(shape)) {
    Py_buffer view;
    if (PyObject_GetBuffer(array.ptr(), &view, PyBUF_WRITABLE) != 0) nb::raise_python_error();
    data = static_cast<T*>(view.buf);  // stays where it is as long as the array lives
    PyBuffer_Release(&view);
  }

  static nb::object empty(const nb::object& shape) {
    const NumpyEmpty& numpy = NumpyEmpty::get();
    if constexpr (std::is_same_v<T, double>) {
      return numpy.empty(shape);
    } else {
      static_assert(std::is_same_v<T, bool> || std::is_same_v<T, std::int64_t>);
      return numpy.empty(shape, std::is_same_v<T, bool> ? numpy.bool_type : numpy.int64_type);
    }
  }
};

/// Writes a shape as NumPy does: (12,), (4, 12).
inline std::string shape_text(std::span<const std::size_t> shape) {
  std::string text = "(";
  for (const std::size_t size : shape) text += (text.size() > 1 ? ", " : "") + std::to_string(size);
  return text + (shape.size() == 1 ? ",)" : ")");
}

/// Returns the numbers of `array` as doubles: those of the array itself, or `copy` of float32.
/// @throws ConfigError naming `what` unless it has this `shape` and either type
template <std::size_t dimensions>
std::span<const double> doubles(const AnyArray& array, const std::array<std::size_t, dimensions>& shape,
                                const char* what, std::vector<double>& copy) {
  const auto wrong = [&](const std::string& found) {
    return ConfigError(what, "array", "float64 or float32 of shape " + shape_text(shape), found);
  };
  bool same = array.ndim() == dimensions;
  for (std::size_t i = 0; same && i < dimensions; ++i) same = array.shape(i) == shape[i];
  if (!same) {
    std::vector<std::size_t> found(array.ndim());
    for (std::size_t i = 0; i < found.size(); ++i) found[i] = array.shape(i);
    throw wrong("shape " + shape_text(found));
  }
  const std::size_t size = array.size();
  if (array.dtype() == nb::dtype<double>()) return {static_cast<const double*>(array.data()), size};
  if (array.dtype() != nb::dtype<float>()) throw wrong("another type");
  copy.resize(size);
  std::copy_n(static_cast<const float*>(array.data()), size, copy.begin());
  return copy;
}

/// Returns whatever NumPy makes numbers of, as float64 in C order: arrays of any type, lists. @throws
/// ConfigError for what is none, complex numbers and dates among it
inline nb::ndarray<const double, nb::c_contig, nb::device::cpu> numbers_of(const nb::object& values) {
  nb::ndarray<const double, nb::c_contig, nb::device::cpu> array;
  if (nb::try_cast(values, array, false)) return array;
  const nb::object numpy = nb::module_::import_("numpy");
  try {
    const nb::object found = numpy.attr("asarray")(values);
    const bool is_real = nb::cast<std::string>(found.attr("dtype").attr("kind")).find_first_of("fiubO") == 0;
    if (is_real)
      return nb::cast<nb::ndarray<const double, nb::c_contig, nb::device::cpu>>(
          numpy.attr("ascontiguousarray")(found, numpy.attr("float64")));
  } catch (const nb::python_error&) {
  }
  throw ConfigError("array", "values", "numbers", shown(values));
}

/// Returns numbers as a vector. @throws ConfigError naming `what` unless it has one dimension
inline Eigen::Map<const Eigen::VectorXd> vector_of(
    const nb::ndarray<const double, nb::c_contig, nb::device::cpu>& array, const char* what) {
  if (array.ndim() != 1) throw ConfigError(what, "array", "one dimension", std::to_string(array.ndim()));
  return {array.data(), static_cast<Eigen::Index>(array.size())};
}

}  // namespace crossgait::python
