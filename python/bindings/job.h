// Long calls: the interpreter goes on, Ctrl-C ends them, and somebody is told how far they are.
#pragma once

#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include <nanobind/nanobind.h>

#include "physics/core/files_read.h"
#include "study/engine_comparison.h"

namespace crossgait::python {

namespace nb = nanobind;

/// Runs work on a thread of its own, for the thread that waits for it.
class Job {
 public:
  /// `work` may throw, and asks its argument now and then whether to go on, which then throws Interrupted. It
  /// owns what it uses: if the caller is interrupted, it goes on until it asks next, and the next job waits
  /// for that.
  /// @param progress  Python's function of a stage and a share, or None
  static void run(std::function<void(const StageProgress&)> work, const nb::object& progress);
  /// Returns when nothing that was interrupted is at work any more.
  static void wait_for_leftovers();
};

/// Returns the value of `make(progress)`, made with the interpreter's lock released.
template <typename Make>
auto run_job(Make make, const nb::object& progress) {
  using Value = std::invoke_result_t<Make, const StageProgress&>;
  const auto value = std::make_shared<std::optional<Value>>();
  Job::run(
      [value, make = std::move(make)](const StageProgress& told) {
        const FilesRead files;  // which `with_files_read` asks for
        value->emplace(make(told));
      },
      progress);
  return std::move(**value);
}

}  // namespace crossgait::python
