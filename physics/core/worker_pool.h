// A fixed number of threads that share out indices.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "physics/core/interruption.h"

namespace crossgait {

/// The most threads of one pool (docs/limits.md).
inline constexpr std::size_t kMaxWorkers = 1024;

/// Calls a function for every index of a range, on all workers at once. Which worker gets which index is left
/// to chance, so results must not depend on it. The caller's thread is one of the workers. A fork of the
/// process has none of the threads: there, a pool of several workers refuses to work.
class WorkerPool {
 public:
  /// @param workers  at least 1; 1 starts no thread
  /// @throws std::system_error if the system grants no more threads
  explicit WorkerPool(std::size_t workers);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;
  WorkerPool(WorkerPool&&) = delete;
  WorkerPool& operator=(WorkerPool&&) = delete;

  std::size_t workers() const noexcept { return threads_->size() + 1; }
  /// Returns which worker of its pool calls, below workers(): 0 is the caller of `run`, and any other thread.
  static std::size_t worker() noexcept;

  /// Calls function(0) ... function(count - 1) and returns when all are done. Allocates nothing. Throws what
  /// the call of lowest index threw, after all others are done.
  /// @throws std::logic_error, calling nothing, in a fork of the process that made the pool
  template <typename Function>
  void run(std::size_t count, const Function& function) {
    run(
        count, [](const void* f, std::size_t i) { (*static_cast<const Function*>(f))(i); }, &function);
  }

 private:
  using Call = void (*)(const void* function, std::size_t index);
  void run(std::size_t count, Call call, const void* function);
  void work() noexcept;
  void serve(std::size_t worker) noexcept;
  void stop() noexcept;
  void wait_for_workers();

  static constexpr std::size_t kLook = std::size_t{1} << 32;
  // Written by the caller between rounds; a change of `round_` hands them to the workers.
  Call call_ = nullptr;
  const void* function_ = nullptr;
  std::size_t count_ = 0;
  Interruptible* interruptible_ = nullptr;  // the caller's
  bool stop_ = false;
  long process_ = 0;  // that has the threads

  std::atomic<std::size_t> round_{0};  // begins with every change
  // Threads that have not finished the round, and kLook for each look that was asked for.
  std::atomic<std::size_t> busy_{0};
  std::atomic<std::size_t> next_{0};  // index that nobody has taken

  std::mutex error_mutex_;
  std::exception_ptr error_;
  std::size_t error_index_ = 0;

  // Last: they use the rest.
  std::unique_ptr<std::vector<std::jthread>> threads_ = std::make_unique<std::vector<std::jthread>>();
};

}  // namespace crossgait
