#include "physics/core/atomic_file.h"

#include <atomic>
#include <cerrno>
#include <chrono>
#include <climits>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "physics/core/error.h"
#include "physics/core/folder.h"
#include "physics/core/input_guard.h"
#include "physics/core/interruption.h"
#include "physics/core/left_over.h"
#include "physics/core/locked_file.h"
#include "physics/core/progress.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

/// "map.png.crossgait-1234-0.tmp": not longer than names may be, and another in every process and thread.
std::string temporary_name(const std::string& name) {
  static std::atomic<unsigned> counter{0};
  const std::string own = fmt::format(".crossgait-{}-{}.tmp", ::getpid(), counter++);
  return name.substr(0, NAME_MAX - own.size()) + own;
}

/// Takes `ending` and digits before it off the end of `name`. @returns whether they were there
bool take_number(std::string_view& name, std::string_view ending) {
  if (!name.ends_with(ending)) return false;
  name.remove_suffix(ending.size());
  const std::size_t number = name.find_last_not_of("0123456789") + 1;
  const bool is_there = number < name.size();
  name = name.substr(0, number);
  return is_there;
}

bool is_temporary(std::string_view name) {
  return take_number(name, ".tmp") && take_number(name, "-") && name.ends_with(".crossgait-");
}

/// A temporary of the Python package is a folder, ".crossgait-k2x9_a1b.tmp".
bool is_temporary_folder(std::string_view name) {
  constexpr std::string_view kBegin = ".crossgait-", kEnd = ".tmp";
  return name.starts_with(kBegin) && name.ends_with(kEnd) && name.size() > kBegin.size() + kEnd.size();
}

constexpr std::chrono::milliseconds kSlice{20};  // by which a signal is noticed late

/// Waits until a pipe takes more, or its reader is gone, which writing tells. @throws Interrupted
void wait_until_taken(int file) {
  constexpr int kPatience = 50;  // slices in which a slow reader is given what was done before the signal
  pollfd watched{file, POLLOUT, 0};
  for (int late = 0; ::poll(&watched, 1, static_cast<int>(kSlice.count())) <= 0;)
    if (interruption_is_asked && ++late > kPatience) throw Interrupted();
}

}  // namespace

void remove_left_over(const std::string& folder) {
  for (const std::string& name : names_in_folder(folder)) {
    if (is_temporary(name)) {
      remove_unless_held(fs::path(folder) / name,
                         [](const fs::path&, const struct stat& status) { return S_ISREG(status.st_mode); });
    } else if (is_temporary_folder(name)) {
      // One that is empty may be about to be locked by whoever made it.
      remove_unless_held(fs::path(folder) / name, [](const fs::path& path, const struct stat& status) {
        std::error_code error;
        return S_ISDIR(status.st_mode) && !fs::is_empty(path, error);
      });
    }
  }
}

std::string place_of_output(const std::string& path) {
  constexpr int kMostLinks = 40;  // as the kernel follows
  fs::path place = path;
  std::error_code error;
  for (int i = 0; i < kMostLinks; ++i) {
    if (!fs::is_symlink(place, error)) return place.string();
    place = place.parent_path() / fs::read_symlink(place, error);  // an absolute one replaces the folder
  }
  throw ConfigError(path, "output file", "links that lead to a place", "a circle of links");
}

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)) {
  if (path_.empty()) throw ConfigError("output file", "name", "one that is not empty", "\"\"");
  check_file_name(path_);
  struct stat existing {};
  special_ = ::stat(path_.c_str(), &existing) == 0 && !S_ISREG(existing.st_mode);
  // What /dev/stdout and a shell's >(...) lead to may have no name.
  place_ = special_ ? path_ : place_of_output(path_);
  if (special_) {
    open_special();
  } else {
    open_temporary();
  }
}

/// Never waiting in a call of the system's, which a signal that has a handler would not end.
void AtomicFile::open_special() {
  target_ = place_;
  while (true) {
    file_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK);
    if (file_ >= 0) return;
    struct stat status {};
    const int code = errno;
    const bool is_unread = code == ENXIO && ::stat(target_.c_str(), &status) == 0 && S_ISFIFO(status.st_mode);
    if (!is_unread && code != EINTR) fail(code);
    if (interruption_is_asked) throw Interrupted();
    std::this_thread::sleep_for(kSlice);
  }
}

void AtomicFile::check_replaced() const {
  InputGuard::check_output(place_);
  if (const std::optional<std::string> writer = writer_of(place_))
    throw ConfigError(path_, "output file", "a file that nobody is writing", *writer);
}

void AtomicFile::open_temporary() {
  check_replaced();
  const fs::path place = place_;
  remove_left_over(place.has_parent_path() ? place.parent_path().string() : ".");
  // What is replaced may be read by as many as before, and not where it may not be written.
  struct stat replaced {};
  const bool is_there = ::stat(place_.c_str(), &replaced) == 0;
  if (is_there && ::faccessat(AT_FDCWD, place_.c_str(), W_OK, AT_EACCESS) != 0) fail(errno);
  while (true) {
    target_ = (place.parent_path() / temporary_name(place.filename().string())).string();
    constexpr mode_t kMode = 0666;  // less the umask, like any other file
    file_ = ::open(target_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
    if (file_ < 0) {
      target_.clear();
      fail(errno);
    }
    if (is_there && ::fchmod(file_, replaced.st_mode & 0777) != 0) fail(errno);
    // Says that its writer lives. Whoever removes what is left over may have had the lock first. Shared: it
    // is still held when the file is in its place, where another output that replaces it is no offence.
    ::flock(file_, LOCK_SH);
    struct stat status {};
    if (::fstat(file_, &status) != 0) fail(errno);
    if (status.st_nlink > 0) return;
    ::close(file_);
  }
}

AtomicFile::~AtomicFile() {
  if (file_ < 0) return;
  ::close(file_);
  if (!special_) ::unlink(target_.c_str());
}

/// @param code  an errno value
void AtomicFile::fail(int code) {
  if (file_ >= 0) ::close(std::exchange(file_, -1));
  if (!special_ && !target_.empty()) ::unlink(target_.c_str());
  throw ConfigError(path_, "output file", "a place that can be written",
                    std::generic_category().message(code));
}

void AtomicFile::write(std::string_view bytes) {
  constexpr std::size_t kBuffer = 1 << 16;
  buffer_ += bytes;
  if (buffer_.size() >= kBuffer) flush();
}

void AtomicFile::flush() {
  std::string_view rest = buffer_;
  while (!rest.empty()) {
    const ssize_t written = ::write(file_, rest.data(), rest.size());
    if (written >= 0) {
      rest.remove_prefix(static_cast<std::size_t>(written));
    } else if (special_ && errno == EAGAIN) {
      wait_until_taken(file_);
    } else if (errno != EINTR) {
      fail(errno);
    }
  }
  buffer_.clear();
}

void AtomicFile::commit() {
  flush();
  if (!special_) {
    if (::fsync(file_) != 0) fail(errno);
    check_replaced();
  }
  // Under the lock, which ends when it is closed. What could fail then has been found by fsync.
  if (!special_ && std::rename(target_.c_str(), place_.c_str()) != 0) fail(errno);
  if (::close(std::exchange(file_, -1)) != 0 && special_) fail(errno);
}

void write_file_atomically(const std::string& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

void check_writable(const std::string& path) {
  struct stat existing {};
  // Opening a pipe would wait for its reader.
  if (::stat(path.c_str(), &existing) == 0 && S_ISFIFO(existing.st_mode)) return;
  const AtomicFile probe(path);
}

}  // namespace crossgait
