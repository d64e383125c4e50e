// Environments as arrays: what there is to see of them, and what changes them between steps.
#pragma once

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>

#include "env/vector_env.h"
#include "physics/core/error.h"

namespace crossgait::python {

/// Says which environments as NumPy's indices do: numbers, a slice or a mask; None is all.
using Indices = nanobind::object;

/// Holds one environment, or all of a vector; its owner outlives it.
struct Batch {
  static constexpr const char* kSource = "environments";  // of errors

  /// Holds a NumPy array and when it was filled.
  struct Held {
    nanobind::object array;  // read-only
    void* data = nullptr;
    std::uint64_t revision = std::numeric_limits<std::uint64_t>::max();
  };

  const void* owner;              // for `check_idle`
  const std::uint64_t* revision;  // of the owner
  VectorEnv* vector;              // null of one environment
  QuadrupedEnv* single;           // null of many
  std::uint64_t* single_revision;
  std::vector<Held> held = {};               // a row of env_arrays() each
  std::vector<nanobind::object> parts = {};  // of env_array_parts()
  nanobind::object random = nanobind::none();

  std::size_t size() const noexcept { return vector != nullptr ? vector->size() : 1; }
  const QuadrupedEnv& at(std::size_t i) const {
    if (vector != nullptr) return std::as_const(*vector).environment(i);
    if (single == nullptr) throw ConfigError("environments", "batch", "an environment", "one that is gone");
    return *single;
  }
  /// Returns the environment to be changed.
  QuadrupedEnv& change(std::size_t i) {
    static_cast<void>(at(i));
    if (vector != nullptr) return vector->edit(i);
    ++*single_revision;
    return *single;
  }
};

/// Returns the numbers of environments. @throws ConfigError for what names none
std::vector<std::size_t> chosen(const Batch& batch, const Indices& indices);

}  // namespace crossgait::python
