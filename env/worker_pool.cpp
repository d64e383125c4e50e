#include "crossgait/env/worker_pool.h"

namespace crossgait {

WorkerPool::WorkerPool(std::size_t workers) {
  for (std::size_t i = 1; i < workers; ++i) {
    threads_.emplace_back([this](const std::stop_token& stop) { serve(stop); });
  }
}

WorkerPool::~WorkerPool() {
  for (std::jthread& thread : threads_) thread.request_stop();
}

void WorkerPool::serve(const std::stop_token& stop) {
  std::size_t seen = 0;
  while (true) {
    {
      std::unique_lock lock(mutex_);
      if (!begin_.wait(lock, stop, [&] { return round_ != seen; })) return;
      seen = round_;
    }
    work();
    const std::scoped_lock lock(mutex_);
    if (--busy_ == 0) end_.notify_one();
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

void WorkerPool::run(std::size_t count, Call call, const void* function) {
  call_ = call;
  function_ = function;
  count_ = count;
  next_ = 0;
  error_ = nullptr;
  if (!threads_.empty()) {
    const std::scoped_lock lock(mutex_);
    busy_ = threads_.size();
    ++round_;
    begin_.notify_all();
  }
  work();
  if (!threads_.empty()) {
    std::unique_lock lock(mutex_);
    end_.wait(lock, [&] { return busy_ == 0; });
  }
  if (error_) std::rethrow_exception(error_);
}

}  // namespace crossgait
