// Objects that one thread at a time may use, though the interpreter's lock is released while they work.
#pragma once

#include <optional>
#include <utility>

#include <nanobind/nanobind.h>

#include "physics/engine/physics_backend.h"
#include "python/bindings/interruption.h"

namespace crossgait::python {

namespace nb = nanobind;

/// Tells an object from others by its address. Views of an object have an overload that gives that one's.
template <typename T>
const void* identity_of(const T& object) noexcept {
  return &object;
}

/// Raises RuntimeError if another thread works at the object. The interpreter's lock is held.
void check_idle(const void* object);

/// Marks an object as worked at and releases the interpreter's lock, until its end.
class Working {
 public:
  /// @throws std::runtime_error as `check_idle`
  explicit Working(const void* object);
  ~Working();
  Working(const Working&) = delete;
  Working& operator=(const Working&) = delete;

 private:
  const void* object_;
  std::optional<nb::gil_scoped_release> release_;
};

/// Calls `function(interruption)` while the object is worked at; Ctrl-C ends its waits for an engine
/// elsewhere, and whatever asks `interruption.came()`. @throws also what a handler of signals raised
template <typename Function>
void work_at(const void* object, const Function& function) {
  Interruption interruption;
  {
    const Working working(object);
    function(interruption);
  }
  interruption.rethrow();
}

/// Wraps a function, for a binding, with `check_idle` of its first argument before it.
template <typename Result, typename Self, typename... Arguments>
auto guarded(Result (*function)(Self&, Arguments...)) {
  return [function](Self& self, Arguments... arguments) -> Result {
    check_idle(identity_of(self));
    return function(self, std::forward<Arguments>(arguments)...);
  };
}
/// Wraps a lambda that captures nothing likewise.
template <typename Lambda>
auto guarded(Lambda lambda) {
  return guarded(+lambda);
}
/// Wraps member functions likewise.
template <typename Result, typename Self, typename... Arguments>
auto guarded(Result (Self::*function)(Arguments...)) {
  return [function](Self& self, Arguments... arguments) -> Result {
    check_idle(identity_of(self));
    return (self.*function)(std::forward<Arguments>(arguments)...);
  };
}
template <typename Result, typename Self, typename... Arguments>
auto guarded(Result (Self::*function)(Arguments...) const) {
  return [function](const Self& self, Arguments... arguments) -> Result {
    check_idle(identity_of(self));
    return (self.*function)(std::forward<Arguments>(arguments)...);
  };
}

}  // namespace crossgait::python
