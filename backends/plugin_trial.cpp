#include "backends/plugin_trial.h"

#include <array>
#include <cerrno>
#include <cfenv>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <optional>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "physics/core/spawn_actions.h"

namespace crossgait {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kEndedByItself = 97;  // what exit() comes to in the fork

/// How the processor computes: which exceptions end the program, how it rounds, and whether it knows numbers
/// below the least normal one, which code that was built with -ffast-math has it forget.
struct Arithmetic {
  int exceptions = fegetexcept(), rounding = std::fegetround();
  bool has_subnormals = [] {
    volatile double least = std::numeric_limits<double>::min();
    least = least / 2;
    return least > 0;
  }();

  bool operator==(const Arithmetic&) const = default;
};

/// What it did to this process that is seen only later; nothing if there is nothing.
std::string harm(const Arithmetic& before) {
  if (Arithmetic() != before) return "it changes how the whole program computes (floating-point environment)";
  for (int stream = 0; stream < 3; ++stream)
    if (::fcntl(stream, F_GETFD) < 0) return "it closes a standard stream of the program";
  return "";
}

/// Ends with this process, leaves no core file, and says nothing but its answer.
void prepare_fork() {
  ::setpgid(0, 0);  // what it starts is ended with it
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit none{0, 0};
  ::setrlimit(RLIMIT_CORE, &none);
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  for (int stream = 0; stream < 3; ++stream) ::dup2(nowhere, stream);
  // Handlers of exit() that stand behind this one are the program's: they would flush and remove what is its.
  std::atexit([] { ::_exit(kEndedByItself); });
}

/// @param answer  where it is written, with a zero behind it: that there is one says that it came so far
[[noreturn]] void run_fork(const std::function<std::string()>& open, int answer) {
  prepare_fork();
  const Arithmetic before;
  std::string reason = open();
  if (reason.empty()) reason = harm(before);
  const char* rest = reason.c_str();
  for (std::size_t left = reason.size() + 1; left > 0;) {
    const ssize_t written = ::write(answer, rest, left);
    if (written < 0 && errno != EINTR) break;
    if (written > 0) {
      rest += written;
      left -= static_cast<std::size_t>(written);
    }
  }
  ::_exit(0);
}

/// Reads up to a zero. @returns whether there was one before `end`; none: the fork is gone, or is late
bool read_answer(int from, Clock::time_point end, std::string& answer) {
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    pollfd watched{from, POLLIN, 0};
    const int ready = left > 0 ? ::poll(&watched, 1, static_cast<int>(left)) : 0;
    if (ready == 0) return false;
    std::array<char, 4096> buffer{};
    const ssize_t count = ready > 0 ? ::read(from, buffer.data(), buffer.size()) : -1;
    if (count == 0 || (count < 0 && errno != EINTR)) return false;
    if (count > 0) answer.append(buffer.data(), static_cast<std::size_t>(count));
    if (const std::size_t zero = answer.find('\0'); zero != std::string::npos) {
      answer.resize(zero);
      return true;
    }
  }
}

/// Waits for the end of a fork that gave no answer. @returns its status; nothing if it lives on at `end`,
/// though it closed what it was to answer on
std::optional<int> status_until(pid_t fork, Clock::time_point end) {
  for (;;) {
    int status = 0;
    const pid_t ended = ::waitpid(fork, &status, WNOHANG);
    if (ended == fork) return status;
    if (ended < 0 && errno != EINTR) return 0;
    if (Clock::now() >= end) return std::nullopt;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void end_and_reap(pid_t fork) {
  ::kill(-fork, SIGKILL);
  ::kill(fork, SIGKILL);  // if it has no group yet
  while (::waitpid(fork, nullptr, 0) < 0 && errno == EINTR) {
  }
}

std::string end_in_words(int status) {
  if (WIFSIGNALED(status))
    return fmt::format("signal {} ({}) ended the process in which it was tried", WTERMSIG(status),
                       ::strsignal(WTERMSIG(status)));
  return "it ended the process in which it was tried";
}

}  // namespace

std::string try_in_fork(const std::function<std::string()>& open, std::chrono::milliseconds limit) {
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) throw_system_error(errno, "a trial of a plug-in");
  const auto end = Clock::now() + limit;
  const pid_t fork = ::fork();
  if (fork == 0) run_fork(open, pipe[1]);
  const int code = errno;
  ::close(pipe[1]);
  std::string answer;
  const bool answered = fork > 0 && read_answer(pipe[0], end, answer);
  ::close(pipe[0]);
  if (fork < 0) throw_system_error(code, "a trial of a plug-in");
  const std::optional<int> status = answered ? std::nullopt : status_until(fork, end);
  if (!status) end_and_reap(fork);
  if (answered) return answer;
  if (!status)
    return fmt::format("it was not opened within {:g} s when it was tried",
                       1e-3 * static_cast<double>(limit.count()));
  return end_in_words(*status);
}

}  // namespace crossgait
