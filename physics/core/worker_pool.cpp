#include "physics/core/worker_pool.h"

#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

namespace crossgait {
namespace {

// Waits until `value` is no longer `old`: for some tens of microseconds awake, which is how soon the next
// round of a batch begins and how far apart two workers finish, then asleep.
void wait_while(const std::atomic<std::size_t>& value, std::size_t old) noexcept {
  constexpr int kYields = 100;
  for (int i = 0; i < kYields; ++i) {
    if (value.load(std::memory_order_acquire) != old) return;
    std::this_thread::yield();
  }
  value.wait(old, std::memory_order_acquire);
}

thread_local std::size_t this_worker = 0;

}  // namespace

std::size_t WorkerPool::worker() noexcept { return this_worker; }

WorkerPool::WorkerPool(std::size_t workers) : process_(::getpid()) {
  try {
    for (std::size_t i = 1; i < workers; ++i) threads_->emplace_back([this, i] { serve(i); });
  } catch (const std::system_error& error) {
    stop();  // those that did start, or joining them would never end
    throw std::runtime_error(fmt::format("worker threads: {} of {} could be started: {}", threads_->size(),
                                         workers - 1, error.code().message()));
  }
}

WorkerPool::~WorkerPool() { stop(); }

void WorkerPool::stop() noexcept {
  if (process_ != ::getpid()) {
    // There is nobody to stop, waiting for their end would never end, and other threads may have taken the
    // memory that the handles stand for: they are not touched any more.
    static_cast<void>(threads_.release());
    return;
  }
  stop_ = true;
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
}

void WorkerPool::serve(std::size_t worker) noexcept {
  this_worker = worker;
  const std::function<void()> have_caller_look = [this] {
    busy_.fetch_add(kLook, std::memory_order_acq_rel);
    busy_.notify_one();
  };
  for (std::size_t seen = 0;; ++seen) {
    wait_while(round_, seen);
    if (stop_) return;
    {
      const WorkingFor caller(interruptible_, have_caller_look);
      work();
    }
    if (busy_.fetch_sub(1, std::memory_order_acq_rel) % kLook == 1) busy_.notify_one();
  }
}

void WorkerPool::work() noexcept {
  for (std::size_t i = next_.fetch_add(1); i < count_; i = next_.fetch_add(1)) {
    try {
      call_(function_, i);
    } catch (...) {
      const std::scoped_lock lock(error_mutex_);
      if (!error_ || i < error_index_) {
        error_ = std::current_exception();
        error_index_ = i;
      }
    }
  }
}

void WorkerPool::wait_for_workers() {
  std::size_t looks = 0;
  for (std::size_t busy = busy_.load(); busy % kLook != 0; busy = busy_.load()) {
    if (busy / kLook != looks) static_cast<void>(interruption_came());
    looks = busy / kLook;
    wait_while(busy_, busy);
  }
}

void WorkerPool::run(std::size_t count, Call call, const void* function) {
  if (!threads_->empty() && process_ != ::getpid()) {
    throw std::logic_error(
        fmt::format("worker threads: they are those of process {}, and this one is a fork of it, which has "
                    "none of them: make "
                    "what works in threads anew in each process, or start processes by spawn instead of fork",
                    process_));
  }
  call_ = call;
  function_ = function;
  count_ = count;
  interruptible_ = Interruptible::current();
  next_ = 0;
  error_ = nullptr;
  busy_ = threads_->size();
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  const std::size_t outside = std::exchange(this_worker, 0);  // of a pool that runs this one
  work();
  this_worker = outside;
  wait_for_workers();
  if (error_) std::rethrow_exception(error_);
}

}  // namespace crossgait
