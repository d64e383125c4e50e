// Calls that take long on the thread that called them: Ctrl-C ends them between two pieces of work.
#pragma once

#include <chrono>

#include "physics/core/interruption.h"

namespace crossgait::python {

/// Asks Python now and then whether a signal came whose handler raises.
class Interruption {
 public:
  /// Call it between pieces of work, with or without the interpreter's lock. @returns whether the work is to
  /// end; Python's error is set then: throw nb::python_error under the lock
  bool came();
  /// Throws what a handler raised, if one did. The interpreter's lock is held.
  void rethrow() const;

 private:
  bool look();

  std::chrono::steady_clock::time_point looked_ = std::chrono::steady_clock::now();
  Interruptible waits_{[this] { return look(); }};  ///< for a served engine within such a piece
};

}  // namespace crossgait::python
