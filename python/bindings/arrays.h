// NumPy arrays in and out.
#pragma once

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "crossgait/physics/error.h"

namespace crossgait::python {

namespace nb = nanobind;

/// What functions take: float64 or float32, of any shape, in C order.
using AnyArray = nb::ndarray<nb::ro, nb::c_contig, nb::device::cpu>;

/// A new array that owns its numbers, which are left as they come, and a view of them.
template <typename T>
struct NewArray {
  T* data;
  nb::ndarray<nb::numpy, T> array;

  explicit NewArray(std::initializer_list<std::size_t> shape) {
    std::size_t size = 1;
    for (const std::size_t n : shape) size *= n;
    data = new T[size];
    nb::capsule owner(data, [](void* p) noexcept { delete[] static_cast<T*>(p); });
    array = nb::ndarray<nb::numpy, T>(data, shape.size(), shape.begin(), owner);
  }
};

/// The numbers of `array` as doubles: those of the array itself, or `copy` of float32.
/// @throws ConfigError naming `what` unless there are `size` of them, of either type
inline std::span<const double> doubles(const AnyArray& array, std::size_t size, const char* what,
                                       std::vector<double>& copy) {
  const auto wrong = [&](const std::string& found) {
    return ConfigError(what, "array", std::to_string(size) + " numbers, float64 or float32", found);
  };
  if (array.size() != size) throw wrong(std::to_string(array.size()) + " numbers");
  if (array.dtype() == nb::dtype<double>()) return {static_cast<const double*>(array.data()), size};
  if (array.dtype() != nb::dtype<float>()) throw wrong("another type");
  copy.resize(size);
  std::copy_n(static_cast<const float*>(array.data()), size, copy.begin());
  return copy;
}

/// Whatever NumPy makes numbers of, as float64 in C order: arrays of any type, lists. @throws as
/// numpy.asarray does
inline nb::ndarray<const double, nb::c_contig, nb::device::cpu> numbers_of(const nb::object& values) {
  nb::ndarray<const double, nb::c_contig, nb::device::cpu> array;
  if (nb::try_cast(values, array, false)) return array;
  const nb::object numpy = nb::module_::import_("numpy");
  return nb::cast<nb::ndarray<const double, nb::c_contig, nb::device::cpu>>(
      numpy.attr("ascontiguousarray")(values, numpy.attr("float64")));
}

/// The same as a vector. @throws ConfigError naming `what` unless it has one dimension
inline Eigen::Map<const Eigen::VectorXd> vector_of(
    const nb::ndarray<const double, nb::c_contig, nb::device::cpu>& array, const char* what) {
  if (array.ndim() != 1) throw ConfigError(what, "array", "one dimension", std::to_string(array.ndim()));
  return {array.data(), static_cast<Eigen::Index>(array.size())};
}

}  // namespace crossgait::python
