// How far a long job is, and how to end it before it is done.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>

namespace crossgait {

/// Called now and then with the share of all work done, in [0, 1]; one call at a time, from any thread.
/// It may throw `Interrupted`.
using Progress = std::function<void(double share)>;

/// Is thrown by a Progress whose owner wants no more. What can hand over the part that is done says so, and
/// returns it; from anything else the exception comes out again.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

/// Tells `progress`, and whether it wants no more: to be asked between parts of a job, since a part that is
/// finished says nothing.
inline bool interrupted_at(const Progress& progress, double share) {
  try {
    if (progress) progress(share);
    return false;
  } catch (const Interrupted&) {
    return true;
  }
}

/// Shares the progress of a job whose parts are done on several threads. An Interrupted ends in it, so that
/// the threads can put down their work instead of taking more.
class SharedProgress {
 public:
  /// @param progress outlives this
  SharedProgress(const Progress& progress, std::size_t parts) : progress_(progress), parts_(parts) {}

  /// Tells, before a part is begun, that no more is wanted.
  bool interrupted() const noexcept { return interrupted_.load(std::memory_order_relaxed); }
  void part_done() {
    const std::scoped_lock lock(mutex_);
    ++done_;
    try {
      if (progress_ && !interrupted()) progress_(static_cast<double>(done_) / static_cast<double>(parts_));
    } catch (const Interrupted&) {
      interrupted_ = true;
    }
  }

 private:
  const Progress& progress_;
  std::size_t parts_, done_ = 0;
  std::mutex mutex_;
  std::atomic<bool> interrupted_{false};
};

/// Returns the part of `progress` that goes from `from` to `to`; nothing if nobody listens.
inline Progress part_of(const Progress& progress, double from, double to) {
  return progress ? Progress([progress, from, to](double share) { progress(from + share * (to - from)); })
                  : Progress();
}

}  // namespace crossgait
