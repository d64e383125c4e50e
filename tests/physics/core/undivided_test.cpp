#include "physics/core/undivided.h"

#include <atomic>
#include <functional>
#include <thread>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "physics/robot/robot.h"
#include "physics/robot_files/data_path.h"

namespace crossgait {
namespace {

/// Forks again and again while another thread is at the same work, which the fork then does.
void expect_forks_to_end(const std::function<void()>& work) {
  constexpr int kForks = 60;
  std::atomic<bool> ended = false;
  std::thread other([&] {
    while (!ended) work();
  });
  int hung = 0;
  for (int i = 0; i < kForks && hung == 0; ++i) {
    const pid_t child = ::fork();
    if (child == 0) {
      ::alarm(60);  // far more than it takes; for ever is what it would wait
      work();
      ::_exit(0);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    hung += status == 0 ? 0 : 1;
  }
  ended = true;
  other.join();
  EXPECT_EQ(hung, 0);
}

TEST(UndividedWork, IsNeverHalfDoneInAFork) {
  expect_forks_to_end([] {
    const Undivided alone;
    const Undivided within;
    ::usleep(2000);
  });
}

TEST(UndividedWork, IsThatOfReadingUrdf) {
  const std::string robot = find_robot("serial_quadruped");
  expect_forks_to_end([&] { load_robot(robot); });
}

TEST(UndividedWork, MayForkItself) {
  const Undivided alone;
  const pid_t child = ::fork();
  if (child == 0) {
    const Undivided again;
    ::_exit(0);
  }
  int status = 1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace crossgait
