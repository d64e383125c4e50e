#include "python/bindings/interruption.h"

#include <nanobind/nanobind.h>

namespace crossgait::python {

bool Interruption::came() { return waits_.came(); }

void Interruption::rethrow() const {
  if (waits_.has_come()) throw nanobind::python_error();
}

bool Interruption::look() {
  constexpr std::chrono::milliseconds kLook{20};
  const auto now = std::chrono::steady_clock::now();
  if (now - looked_ < kLook) return false;
  looked_ = now;
  const nanobind::gil_scoped_acquire lock;
  return PyErr_CheckSignals() != 0;
}

}  // namespace crossgait::python
