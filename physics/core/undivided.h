// Work that a fork never finds half done.
#pragma once

#include <mutex>
#include <new>

#include <pthread.h>

namespace crossgait {

/// Holds, while it lives, a lock of the whole process that a fork takes as well: a fork waits until the work
/// is done, so that in the new process, which has none of the other threads, nobody waits for one of them to
/// end it. For what is short and has a state of the process; within one another, and around a fork that the
/// work itself begins, they do no harm.
class Undivided {
 public:
  Undivided() { begin(); }
  ~Undivided() { end(); }
  Undivided(const Undivided&) = delete;
  Undivided& operator=(const Undivided&) = delete;
  Undivided(Undivided&&) = delete;
  Undivided& operator=(Undivided&&) = delete;

 private:
  struct Locks {
    std::mutex work;
    std::mutex turn;  // of who waits for work, so that a thread which is always at it lets a fork in
  };
  // Counted here: a std::recursive_mutex belongs to a thread's number, which is another one in a fork.
  static inline thread_local int depth = 0;

  static Locks& locks() {
    // Never destroyed: forks come until the very end.
    static auto* const one = [] {
      ::pthread_atfork(begin, end, end_in_child);
      return new Locks;
    }();
    return *one;
  }
  // Made with the program: a fork while another thread made them would find them half made, and wait for
  // ever.
  static inline Locks& made = locks();

  static void begin() {
    if (depth == 0) {
      const std::lock_guard<std::mutex> turn(locks().turn);
      locks().work.lock();
    }
    ++depth;
  }
  static void end() {
    if (--depth == 0) locks().work.unlock();
  }
  // Whose turn it was stayed behind.
  static void end_in_child() {
    new (&locks().turn) std::mutex;
    end();
  }
};

}  // namespace crossgait
