#include "physics/core/child_process.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <limits>
#include <memory>
#include <thread>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "physics/core/spawn_actions.h"

namespace crossgait {
namespace {

struct CloseFile {
  void operator()(FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<FILE, CloseFile>;

/// A file without a name, gone when closed: unlike a pipe it never makes a writer wait.
File nameless_file() {
  File file(std::tmpfile());
  if (!file) throw_system_error(errno, "temporary file");
  return file;
}

/// @param most  bytes, where they are limited: a quick writer is past its limit before the limit holds
std::string read_from_start(FILE* file, std::size_t most) {
  std::rewind(file);
  std::string text;
  std::array<char, 65536> buffer{};
  while (const std::size_t count =
             std::fread(buffer.data(), 1, std::min(buffer.size(), most - text.size()), file)) {
    text.append(buffer.data(), count);
  }
  return text;
}

/// The processor's time and the size of files are limits of the child's own, which hold when this program is
/// gone as well.
void limit(pid_t child, const ChildLimits& limits) {
  // Of a hard limit as low as the soft one the system makes a SIGKILL, which says nothing.
  const auto seconds = static_cast<rlim_t>(limits.time.count());
  const rlimit time{seconds, seconds + 1};
  const rlimit bytes{limits.bytes, limits.bytes};
  // Of a child that has ended already there is nothing to limit.
  prlimit(child, RLIMIT_CPU, &time, nullptr);
  prlimit(child, RLIMIT_FSIZE, &bytes, nullptr);
}

volatile std::sig_atomic_t handed_to = 0;  // the child, while there is one
volatile std::sig_atomic_t came = 0;       // the signal

extern "C" void hand_on(int signal, siginfo_t* about, void* /*context*/) {
  came = signal;
  // A terminal's Ctrl-C goes to all that it runs.
  if (handed_to != 0 && about->si_code != SI_KERNEL) ::kill(handed_to, signal);
}

/// Hands signals on to a child from its beginning to its end, and raises at last the one that came.
class HandedOn {
 public:
  HandedOn() {
    came = 0;
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
      struct sigaction action {};
      action.sa_sigaction = hand_on;
      action.sa_flags = SA_SIGINFO;
      ::sigemptyset(&action.sa_mask);
      ::sigaction(kSignals[i], nullptr, &before_[i]);
      if (before_[i].sa_handler != SIG_IGN) ::sigaction(kSignals[i], &action, nullptr);
    }
  }
  ~HandedOn() {
    handed_to = 0;
    for (std::size_t i = 0; i < kSignals.size(); ++i) ::sigaction(kSignals[i], &before_[i], nullptr);
    if (came != 0) std::raise(came);
  }
  HandedOn(const HandedOn&) = delete;
  HandedOn& operator=(const HandedOn&) = delete;

  static void to(pid_t child) {
    handed_to = child;
    if (came != 0) ::kill(child, came);  // before there was one
  }

 private:
  static constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, kSignals.size()> before_{};
};

/// Waits for the end of a child. @returns its status, and whether it was ended here
std::pair<int, bool> wait_for(pid_t child, const char* name, const std::optional<ChildLimits>& limits) {
  const auto begin = std::chrono::steady_clock::now();
  bool ended_here = false;
  int status = 0;
  for (;;) {
    const pid_t done = waitpid(child, &status, limits && !ended_here ? WNOHANG : 0);
    if (done == child) return {status, ended_here};
    if (done < 0 && errno != EINTR) throw_system_error(errno, name);
    if (done != 0) continue;
    ended_here = std::chrono::steady_clock::now() - begin > limits->time;
    if (ended_here) {
      kill(child, SIGKILL);
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
}

}  // namespace

std::optional<ChildResult> run_child(const std::vector<std::string>& command, ChildErrors errors,
                                     std::optional<ChildLimits> limits, ChildSignals signals) {
  const File in = nameless_file(), out = nameless_file(), complaints = nameless_file();
  SpawnActions actions;
  actions.connect(fileno(in.get()), STDIN_FILENO);
  actions.connect(fileno(out.get()), STDOUT_FILENO);
  if (errors == ChildErrors::kKept) actions.connect(fileno(complaints.get()), STDERR_FILENO);

  std::vector<std::string> words = command;
  const std::vector<char*> arguments = spawn_words(words);
  pid_t child = 0;
  std::optional<HandedOn> handed_on;
  if (signals == ChildSignals::kHandedOn) handed_on.emplace();
  const int code =
      posix_spawnp(&child, words.front().c_str(), actions.get(), nullptr, arguments.data(), environ);
  if (code == ENOENT) return std::nullopt;
  if (code != 0) throw_system_error(code, words.front());
  if (handed_on) HandedOn::to(child);
  if (limits) limit(child, *limits);
  const auto [status, ended_here] = wait_for(child, words.front().c_str(), limits);
  handed_on.reset();
  const std::size_t most = limits ? limits->bytes : std::numeric_limits<std::size_t>::max();
  ChildResult result{WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_from_start(out.get(), most),
                     read_from_start(complaints.get(), most)};
  const bool limited = WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGXFSZ);
  // A program that ignores the signal finds its writes fail instead.
  result.over_limit = limits && (ended_here || limited || result.out.size() >= limits->bytes);
  return result;
}

}  // namespace crossgait
