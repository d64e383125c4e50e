#include "python/bindings/interruption.h"

#include <nanobind/nanobind.h>

namespace crossgait::python {

bool Interruption::came() {
  constexpr std::chrono::milliseconds kLook{20};
  const auto now = std::chrono::steady_clock::now();
  if (now - looked_ < kLook) return false;
  looked_ = now;
  const nanobind::gil_scoped_acquire lock;
  return PyErr_CheckSignals() != 0;
}

}  // namespace crossgait::python
