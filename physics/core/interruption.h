// A wish that what is at work end, where those who wait for something outside can see it.
#pragma once

#include <atomic>
#include <functional>
#include <thread>

namespace crossgait {

/// Is set by the program's handler of signals. Who waits for something outside asks `interruption_came` now
/// and then, and throws Interrupted (physics/core/progress.h); where no handler sets it, a signal ends the
/// program itself.
inline std::atomic<bool> interruption_is_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free);  // or a handler could not set it

/// Is asked, while it lives, by whatever waits on its thread, and on threads of pools that work for it: for
/// callers who learn of a signal in their own way.
class Interruptible {
 public:
  /// @param asked  whether work is to end; called on this thread alone
  explicit Interruptible(std::function<bool()> asked);
  ~Interruptible();
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

  /// Returns the innermost of this thread, or null.
  static Interruptible* current() noexcept;
  /// Asks, on its own thread; elsewhere says what was answered last. True for ever once it was.
  bool came();
  /// Tells what was answered last, without asking.
  bool has_come() const noexcept { return came_; }

 private:
  const std::function<bool()> asked_;
  const std::thread::id thread_ = std::this_thread::get_id();
  std::atomic<bool> came_{false};
  Interruptible* const outer_;
};

/// Works, while it lives, for another thread: this one's waits ask what interrupts that one.
class WorkingFor {
 public:
  /// @param other  of the other thread, or null
  /// @param have_it_ask  has the other thread call `came`, if it waits for this one; outlives this
  WorkingFor(Interruptible* other, const std::function<void()>& have_it_ask) noexcept;
  ~WorkingFor();
  WorkingFor(const WorkingFor&) = delete;
  WorkingFor& operator=(const WorkingFor&) = delete;
};

/// Tells who waits whether to give up.
bool interruption_came();

}  // namespace crossgait
