// Several processes on one run store: no run that was stored is lost, none is there twice.
#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <functional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "physics/core/error.h"
#include "study/run_store.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

nlohmann::json run_number(int number) { return {{"number", number}}; }
RunResult result_number(int number) {
  return {{"number"}, {{static_cast<double>(number)}, Outcome::kWalked, 1}};
}

class WritersOfOneStore : public ScratchFolder {
 protected:
  /// A process that calls `work` and ends; what it writes to the descriptor that it is given comes to
  /// `read_end`.
  static pid_t start(const std::function<void(int)>& work, int& read_end) {
    std::array<int, 2> ends{};
    EXPECT_EQ(::pipe(ends.data()), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      ::close(ends[0]);
      try {
        work(ends[1]);
      } catch (...) {
        ::_exit(1);
      }
      ::_exit(0);
    }
    ::close(ends[1]);
    read_end = ends[0];
    return child;
  }
  static std::vector<int> numbers_from(int read_end) {
    std::vector<int> numbers;
    int number = 0;
    while (::read(read_end, &number, sizeof number) == static_cast<ssize_t>(sizeof number))
      numbers.push_back(number);
    ::close(read_end);
    return numbers;
  }
  /// Opens the store again and again, a few runs at a time, and tells of each that was stored.
  void add_all(int writer, int runs, int told) const {
    for (int k = 0; k < runs;) {
      try {
        RunStore store(file());
        for (const int end = std::min(runs, k + 5); k < end; ++k) {
          const int number = 1000 * writer + k;
          store.add(run_number(number), result_number(number));
          if (::write(told, &number, sizeof number) != static_cast<ssize_t>(sizeof number)) ::_exit(1);
        }
      } catch (const ConfigError& error) {
        if (error.expected() != "one writer at a time") throw;
      }
      ::usleep(500);  // the others' turn
    }
  }
  void expect_each_once(const std::vector<int>& stored, std::size_t others) const {
    std::set<std::string> different;
    std::istringstream in(read(file()));
    std::size_t count = 0;
    for (std::string line; std::getline(in, line); ++count) different.insert(line);
    EXPECT_EQ(different.size(), count) << "a run is there twice";
    const RunStore store(file());
    for (const int number : stored) {
      const auto found = store.find(run_number(number));
      ASSERT_TRUE(found.has_value()) << number << " was stored, and is lost";
      EXPECT_EQ(found->run.values, result_number(number).run.values);
    }
    // What was stored just before its writer was killed it could not tell.
    EXPECT_GE(store.size(), stored.size());
    EXPECT_LE(store.size(), stored.size() + others);
  }
  std::string file() const { return path("runs.jsonl"); }
};

TEST_F(WritersOfOneStore, LoseNothing) {
  for (const int writers : {2, 8}) {
    std::filesystem::remove(file());
    std::vector<int> stored, ends(static_cast<std::size_t>(writers));
    std::vector<pid_t> children;
    for (int w = 0; w < writers; ++w)
      children.push_back(
          start([=, this](int told) { add_all(w, 40, told); }, ends[static_cast<std::size_t>(w)]));
    for (const int end : ends) {
      const std::vector<int> numbers = numbers_from(end);
      EXPECT_EQ(numbers.size(), 40U);
      stored.insert(stored.end(), numbers.begin(), numbers.end());
    }
    for (const pid_t child : children) {
      int status = 0;
      ::waitpid(child, &status, 0);
      EXPECT_EQ(status, 0);
    }
    expect_each_once(stored, 0);
  }
}

TEST_F(WritersOfOneStore, ThatAreKilledLoseNothingThatWasStored) {
  std::vector<int> stored;
  constexpr int kKilled = 40;
  for (int k = 0; k < kKilled; ++k) {
    int end = 0;
    const pid_t child = start([=, this](int told) { add_all(k, 900, told); }, end);
    int first = 0;  // it is at work
    ASSERT_EQ(::read(end, &first, sizeof first), static_cast<ssize_t>(sizeof first));
    stored.push_back(first);
    ::usleep(static_cast<useconds_t>(37 * k));  // so that each is killed somewhere else
    ::kill(child, SIGKILL);
    const std::vector<int> numbers = numbers_from(end);
    stored.insert(stored.end(), numbers.begin(), numbers.end());
    ::waitpid(child, nullptr, 0);
  }
  expect_each_once(stored, kKilled);
}

// A process for which flock fails as on a file system without locks.
void refuse_locks() {
  std::array<sock_filter, 4> filter{{
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, 0),  // the number of the system call is the first member of its data
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_flock, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EOPNOTSUPP),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  }};
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
      ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0)
    ::_exit(2);
}

TEST_F(WritersOfOneStore, NeedAFileSystemWithLocks) {
  int end = 0;
  const pid_t child = start(
      [this](int told) {
        refuse_locks();
        const ConfigError error = config_error([this] { RunStore{file()}; });
        const int as_said =
            error.source() == file() && error.expected() == "a file system with locks (flock)" ? 1 : 0;
        if (::write(told, &as_said, sizeof as_said) < 0) ::_exit(1);
      },
      end);
  const std::vector<int> said = numbers_from(end);
  int status = 0;
  ::waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 2) GTEST_SKIP() << "this kernel filters no system calls";
  EXPECT_EQ(said, std::vector<int>{1});
}

}  // namespace
}  // namespace crossgait
