#include "python/bindings/job.h"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <nanobind/stl/string.h>

#include "physics/core/files_read.h"
#include "physics/core/interruption.h"

namespace crossgait::python {
namespace {

using namespace std::chrono_literals;

struct Shared {
  std::mutex mutex;
  std::condition_variable changed;
  bool done = false, stop = false;
  std::string stage;
  double share = 0;
  std::exception_ptr error;
  std::vector<FileRead> files;  // that were read for it
};

// Jobs whose callers were interrupted. The process ends after they have.
class Leftovers {
 public:
  ~Leftovers() { wait(); }
  void add(std::thread thread) {
    const std::scoped_lock lock(mutex_);
    threads_.push_back(std::move(thread));
  }
  void wait() {
    const std::scoped_lock lock(mutex_);
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }

 private:
  std::mutex mutex_;
  std::vector<std::thread> threads_;
};

Leftovers& leftovers() {
  static Leftovers all;
  return all;
}

void tell(const nb::object& progress, const std::string& stage, double share) {
  if (!progress.is_none()) progress(stage, share);
}

void work_on(Shared& shared, const std::function<void(const StageProgress&)>& work) {
  const StageProgress told = [&shared](const std::string& stage, double share) {
    const std::scoped_lock lock(shared.mutex);
    shared.stage = stage;
    shared.share = share;
    if (shared.stop) throw Interrupted();
  };
  const Interruptible waits([&shared] {
    const std::scoped_lock lock(shared.mutex);
    return shared.stop;
  });
  std::exception_ptr error;
  const FilesRead read;
  try {
    work(told);
  } catch (...) {
    error = std::current_exception();
  }
  const std::scoped_lock lock(shared.mutex);
  shared.error = error;
  shared.files = read.list();
  shared.done = true;
  shared.changed.notify_all();
}

// Asked to stop; what does not within this time is left to end by itself.
constexpr auto kPatience = 40ms, kLook = 40ms;

void stop(Shared& shared, std::thread thread) {
  const nb::gil_scoped_release release;  // what runs may need it to come to its end
  std::unique_lock lock(shared.mutex);
  shared.stop = true;
  if (shared.changed.wait_for(lock, kPatience, [&shared] { return shared.done; })) {
    lock.unlock();
    thread.join();
  } else {
    lock.unlock();
    leftovers().add(std::move(thread));
  }
}

// @returns whether it is done
bool wait(Shared& shared, std::string& stage, double& share) {
  const nb::gil_scoped_release release;
  std::unique_lock lock(shared.mutex);
  const bool done = shared.changed.wait_for(lock, kLook, [&shared] { return shared.done; });
  stage = shared.stage;
  share = shared.share;
  return done;
}

}  // namespace

void Job::wait_for_leftovers() {
  const nb::gil_scoped_release release;
  leftovers().wait();
}

void Job::run(std::function<void(const StageProgress&)> work, const nb::object& progress) {
  wait_for_leftovers();
  const auto shared = std::make_shared<Shared>();
  std::thread thread([shared, work = std::move(work)]() mutable {
    work_on(*shared, work);
    work = nullptr;
  });
  std::string stage;
  double share = 0;
  while (!wait(*shared, stage, share)) {
    try {
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
      tell(progress, stage, share);
    } catch (...) {
      stop(*shared, std::move(thread));
      throw;
    }
  }
  {
    const nb::gil_scoped_release release;
    thread.join();
  }
  FilesRead::note(shared->files);
  if (shared->error) std::rethrow_exception(shared->error);
  tell(progress, shared->stage, 1);
}

}  // namespace crossgait::python
