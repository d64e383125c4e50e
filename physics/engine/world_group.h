// What worlds that are alike share, so that many of them take little more memory, and caches, than one.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace crossgait {

/// Belongs to worlds that are stepped by the threads of one pool, and never two at once by one thread: an
/// engine may keep one model for all of them, and what a step takes once for each thread. Which worlds of a
/// group are alike, the engine looks at itself.
class WorldGroup {
 public:
  /// @param threads  of the WorkerPool that steps the worlds, the caller's included
  explicit WorldGroup(std::size_t threads);

  std::size_t threads() const noexcept { return threads_; }
  /// Returns the number of the calling thread in its pool, below threads(); 0 outside of one.
  std::size_t thread() const noexcept;

  /// Returns what an engine keeps for the group: what `make` made for the first world that asked. Locks.
  /// @param engine  whose it is: the engine's name
  template <typename Part, typename Make>
  std::shared_ptr<Part> part(const std::string& engine, const Make& make) {
    const std::scoped_lock lock(mutex_);
    std::shared_ptr<void>& kept = parts_[engine];
    if (kept == nullptr) kept = make();
    return std::static_pointer_cast<Part>(kept);
  }

 private:
  std::size_t threads_;
  std::size_t (*worker_)() noexcept;  // of the program; a plug-in has a copy of its own of what is static
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<void>> parts_;
};

}  // namespace crossgait
