// Calls that take long on the thread that called them: Ctrl-C ends them between two pieces of work.
#pragma once

#include <chrono>

namespace crossgait::python {

/// Asks Python now and then whether a signal came whose handler raises.
class Interruption {
 public:
  /// Call it between pieces of work, with or without the interpreter's lock. @returns whether the work is to
  /// end; Python's error is set then: throw nb::python_error under the lock
  bool came();

 private:
  std::chrono::steady_clock::time_point looked_ = std::chrono::steady_clock::now();
};

}  // namespace crossgait::python
