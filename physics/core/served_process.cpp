#include "physics/core/served_process.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "physics/core/error.h"
#include "physics/core/interruption.h"
#include "physics/core/progress.h"
#include "physics/core/spawn_actions.h"
#include "physics/core/text.h"

namespace crossgait {
namespace {

using Clock = std::chrono::steady_clock;

// What is kept of a program's output: enough for the end of a traceback.
constexpr std::size_t kKeptOutput = 4096;
// Descriptors on which the program finds its own, the lowest beside the three of every program.
constexpr int kSocketThere = 3, kMemoryThere = 4, kLifelineThere = 5;

struct Message {
  std::uint32_t number, word;
};

// Above those that the program is handed, or handing over one would overwrite the next.
int moved_up(int descriptor) {
  constexpr int kAbove = 10;
  const int moved = fcntl(descriptor, F_DUPFD_CLOEXEC, kAbove);
  const int code = errno;
  close(descriptor);
  if (moved < 0) throw_system_error(code, "a served program");
  return moved;
}

void close_one(int& descriptor) noexcept {
  if (descriptor >= 0) close(descriptor);
  descriptor = -1;
}

std::vector<std::string> environment_with(std::string_view variable, const std::string& value) {
  std::vector<std::string> result;
  const std::string beginning = fmt::format("{}=", variable);
  for (char** entry = environ; *entry != nullptr; ++entry)
    if (!std::string_view(*entry).starts_with(beginning)) result.emplace_back(*entry);
  result.push_back(beginning + value);
  // One request at a time: more threads of a library of linear algebra wait for one another, and sum in
  // another order.
  for (const char* threads : {"OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"})
    if (std::getenv(threads) == nullptr) result.push_back(fmt::format("{}=1", threads));
  return result;
}

/// Has the system kill a group of processes once the other end of a pipe is closed, which it is when this
/// process is gone, however it went: nothing has to be done, or be let run, in the group for it.
void have_group_killed(int pipe, pid_t group) {
  if (fcntl(pipe, F_SETSIG, SIGKILL) != 0 || fcntl(pipe, F_SETOWN, -group) != 0 ||
      fcntl(pipe, F_SETFL, O_ASYNC) != 0)
    throw_system_error(errno, "a served program");
}

}  // namespace

std::chrono::duration<double> served_limit() {
  const char* said = std::getenv(kServedLimitVariable);
  if (said == nullptr || *said == '\0') return std::chrono::duration<double>(kServedLimit);
  const std::optional<double> seconds = parse_number(said);
  constexpr double kMost = 86400;
  if (!seconds || !(*seconds > 0) || *seconds > kMost)
    throw ConfigError("environment", kServedLimitVariable,
                      fmt::format("seconds that an answer may take, above 0 and at most {}", kMost),
                      fmt::format("'{}'", said));
  return std::chrono::duration<double>(*seconds);
}

ServedProcess::ServedProcess(std::string source, const std::vector<std::string>& command, std::size_t numbers,
                             std::chrono::duration<double> limit)
    : source_(std::move(source)), limit_(limit), numbers_(numbers), owner_(getpid()) {
  const std::size_t size = kServedNumbersAt + numbers_;
  std::array<int, 2> sockets{-1, -1}, life{-1, -1}, output{-1, -1};
  try {
    memory_file_ = memfd_create("crossgait", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    if (memory_file_ < 0) throw_system_error(errno, "shared memory");
    memory_file_ = moved_up(memory_file_);
    // Sealed in its size: a program that cut it off would have us touch what is not there.
    if (ftruncate(memory_file_, static_cast<off_t>(size)) != 0 ||
        fcntl(memory_file_, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0)
      throw_system_error(errno, "shared memory");
    void* mapped = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, memory_file_, 0);
    if (mapped == MAP_FAILED) throw_system_error(errno, "shared memory");
    memory_ = static_cast<std::byte*>(mapped);
    new (memory_) ServedHeader;
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, sockets.data()) != 0 ||
        pipe2(life.data(), O_CLOEXEC) != 0 || pipe2(output.data(), O_CLOEXEC) != 0)
      throw_system_error(errno, "a served program");
    for (auto* pair : {&sockets, &life, &output})
      for (int& descriptor : *pair) descriptor = moved_up(descriptor);
    std::swap(socket_, sockets[0]);
    std::swap(lifeline_, life[1]);
    std::swap(output_, output[0]);
    if (fcntl(output_, F_SETFL, O_NONBLOCK) != 0) throw_system_error(errno, "a served program");
    start(command, sockets[1], life[0], output[1]);
  } catch (...) {
    for (auto* pair : {&sockets, &life, &output})
      for (int& descriptor : *pair) close_one(descriptor);
    end();
    if (memory_ != nullptr) munmap(memory_, size);
    throw;
  }
  for (auto* pair : {&sockets, &life, &output})
    for (int& descriptor : *pair) close_one(descriptor);
}

ServedProcess::~ServedProcess() {
  end();
  if (memory_ != nullptr) munmap(memory_, kServedNumbersAt + numbers_);
}

void ServedProcess::start(const std::vector<std::string>& command, int socket, int lifeline, int output) {
  SpawnActions actions;
  actions.open("/dev/null", STDIN_FILENO, O_RDONLY);
  actions.connect(output, STDOUT_FILENO);
  actions.connect(output, STDERR_FILENO);
  actions.connect(socket, kSocketThere);
  actions.connect(memory_file_, kMemoryThere);
  actions.connect(lifeline, kLifelineThere);
  posix_spawnattr_t attributes{};
  posix_spawnattr_init(&attributes);
  // A session of its own: Ctrl-C is for whoever asks, who may want one more answer.
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  std::vector<std::string> arguments = command;
  std::vector<std::string> environment =
      environment_with(kServedVariable, fmt::format("{}:{}:{}", kSocketThere, kMemoryThere, kLifelineThere));
  const int code = posix_spawnp(&child_, arguments.front().c_str(), actions.get(), &attributes,
                                spawn_words(arguments).data(), spawn_words(environment).data());
  posix_spawnattr_destroy(&attributes);
  if (code == 0) {
    have_group_killed(lifeline, child_);
    return;
  }
  child_ = -1;
  if (code == ENOENT)
    throw ConfigError(source_, "program", "a program that can be run (CROSSGAIT_PYTHON names Python)",
                      fmt::format("no '{}'", arguments.front()));
  throw_system_error(code, arguments.front());
}

bool ServedProcess::is_of_another_process() const noexcept { return getpid() != owner_; }

bool ServedProcess::request(std::uint32_t what, const char* name) noexcept {
  if (is_lost()) return false;
  try {
    if (is_of_another_process()) {
      failed_request_ = name;
      expected_ = fmt::format("process {}, which started it", owner_);
      failure_ = fmt::format("a fork of it, {}: make it anew in each process", getpid());
      return false;
    }
    const Message message{++requests_, what};
    if (send(socket_, &message, sizeof message, MSG_NOSIGNAL) == sizeof message)
      return wait(message.number, name);
    lose(name, "a program that takes requests", how_it_ended());
  } catch (const std::exception& error) {
    lose(name, "an answer", error.what());
  }
  return false;
}

// Waits in slices, so that a clock that is watched in between bounds the whole.
bool ServedProcess::wait(std::uint32_t number, const char* name) {
  constexpr int kSlice = 100;                   // ms
  constexpr std::chrono::seconds kPatience{1};  // in which whoever is well answers, and nothing is lost
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(limit_);
  const auto patient = Clock::now() + kPatience;
  std::size_t written = 0;
  std::array<pollfd, 2> watched{pollfd{socket_, POLLIN, 0}, pollfd{output_, POLLIN, 0}};
  for (;;) {
    const int ready = poll(watched.data(), watched.size(), kSlice);
    if (ready < 0 && errno != EINTR) throw_system_error(errno, "poll");
    if (ready > 0 && watched[0].revents != 0) return read_answer(number, name);
    if (ready > 0 && watched[1].revents != 0) {
      if (!drain(written)) watched[1].fd = -1;  // it has closed its outputs, which it may
      if (written > kMostOutput) {
        lose(name, fmt::format("at most {} bytes of output within a request", kMostOutput),
             fmt::format("more, which ends '{}'", printable_text(output_end_, 200)));
        return false;
      }
    }
    if (Clock::now() > patient && interruption_came()) {
      interrupted_ = true;
      lose(name, "an answer", "an interruption before it came");
      return false;
    }
    if (Clock::now() > end) {
      lose(name, fmt::format("an answer within {:g} s ({} sets it)", limit_.count(), kServedLimitVariable),
           "none");
      return false;
    }
  }
}

bool ServedProcess::read_answer(std::uint32_t number, const char* name) {
  struct {
    Message message;
    std::array<char, 56> more;  // so that a longer one is seen to be
  } answer{};
  const ssize_t size = recv(socket_, &answer, sizeof answer, MSG_DONTWAIT);
  if (size == 0 || (size < 0 && errno == ECONNRESET)) {
    lose(name, "an answer", how_it_ended());
  } else if (size != sizeof(Message)) {
    lose(name, fmt::format("an answer of {} bytes", sizeof(Message)), fmt::format("{} bytes", size));
  } else if (answer.message.number != number) {
    lose(name, fmt::format("an answer to request {}", number),
         fmt::format("one to request {}", answer.message.number));
  } else if (answer.message.word != 0) {
    lose(name, "an answer", printable_text(text(), 1000));
  }
  return !is_lost();
}

// Takes what there is of output. @returns false at its end
bool ServedProcess::drain(std::size_t& written) {
  std::array<char, 4096> buffer{};
  for (;;) {
    const ssize_t count = read(output_, buffer.data(), buffer.size());
    if (count == 0) return false;
    if (count < 0) return errno == EAGAIN || errno == EINTR;
    written += static_cast<std::size_t>(count);
    output_end_.append(buffer.data(), static_cast<std::size_t>(count));
    if (output_end_.size() > kKeptOutput) output_end_.erase(0, output_end_.size() - kKeptOutput);
    if (written > kMostOutput) return true;
  }
}

// It has closed the socket: ended, or about to.
std::string ServedProcess::how_it_ended() {
  constexpr int kTries = 100;  // of 5 ms
  siginfo_t ended{};
  for (int i = 0; i < kTries && ended.si_pid == 0; ++i) {
    // Not reaped, so that its number stays its own, and its group's, until `end`.
    if (waitid(P_PID, static_cast<id_t>(child_), &ended, WEXITED | WNOHANG | WNOWAIT) != 0) break;
    if (ended.si_pid == 0) usleep(5000);
  }
  std::size_t written = 0;
  drain(written);
  std::string how = "that it closed its socket";
  if (ended.si_pid == child_) {
    how = ended.si_code == CLD_EXITED
              ? fmt::format("that it ended with exit code {}", ended.si_status)
              : fmt::format("that signal {} ({}) ended it", ended.si_status, strsignal(ended.si_status));
  }
  while (output_end_.ends_with('\n')) output_end_.pop_back();
  // Of a traceback the last line says what was wrong.
  const std::string last = output_end_.substr(output_end_.rfind('\n') + 1);
  return last.empty() ? how : fmt::format("{}, after '{}'", how, printable_text(last, 500));
}

void ServedProcess::lose(const char* request, const std::string& expected,
                         const std::string& found) noexcept {
  failed_request_ = request;
  expected_ = expected;
  failure_ = found.empty() ? "nothing" : found;
  end();
}

void ServedProcess::throw_if_lost() const {
  if (interrupted_) throw Interrupted();
  if (is_lost()) throw ConfigError(source_, failed_request_, expected_, failure_);
}

std::string_view ServedProcess::text() const {
  const auto size = reinterpret_cast<const ServedHeader*>(memory_)->text_size;
  if (size > kServedText)
    throw ConfigError(source_, "text", fmt::format("at most {} bytes", kServedText),
                      fmt::format("{} bytes", size));
  return {reinterpret_cast<const char*>(memory_) + kServedTextAt, size};
}

void ServedProcess::set_text(std::string_view text) {
  if (text.size() > kServedText)
    throw ConfigError(source_, "text", fmt::format("at most {} bytes", kServedText),
                      fmt::format("{} bytes", text.size()));
  std::memcpy(memory_ + kServedTextAt, text.data(), text.size());
  reinterpret_cast<ServedHeader*>(memory_)->text_size = text.size();
}

// The memory stays until this object goes: callers read numbers of a lost program without harm.
void ServedProcess::end() noexcept {
  close_one(socket_);
  close_one(lifeline_);
  close_one(output_);
  close_one(memory_file_);
  if (child_ > 0 && !is_of_another_process()) {
    kill(-child_, SIGKILL);  // its group: what it started as well
    kill(child_, SIGKILL);
    while (waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
    }
    child_ = -1;
  }
}

}  // namespace crossgait
