#include "physics/core/locked_file.h"

#include <cerrno>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include "physics/core/atomic_file.h"
#include "physics/core/error.h"
#include "physics/core/folder.h"

namespace crossgait {
namespace {

constexpr std::chrono::seconds kSyncEvery{2};  // what a power cut may cost at most

/// Who holds the lock of this file, in words; the kernel does not tell of processes in other containers or on
/// other machines.
std::string holder_of(const struct stat& status) {
  const std::string file =
      fmt::format("{:02x}:{:02x}:{}", major(status.st_dev), minor(status.st_dev), status.st_ino);
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    // "7: FLOCK  ADVISORY  WRITE 1234 fd:00:5326004 0 EOF"; who waits has an arrow behind the number.
    std::istringstream words(line);
    std::string number, kind, advice, access, process, locked;
    if (words >> number >> kind >> advice >> access >> process >> locked && kind == "FLOCK" && locked == file)
      return fmt::format("one that process {} is writing", process);
  }
  return "one that another process is writing";
}

bool is_at(const std::string& path, const struct stat& opened) {
  struct stat now {};
  return ::stat(path.c_str(), &now) == 0 && now.st_dev == opened.st_dev && now.st_ino == opened.st_ino;
}

void check_regular(const std::string& path, const struct stat& status) {
  if (!S_ISREG(status.st_mode))
    throw ConfigError(path, "file", "a regular file",
                      S_ISDIR(status.st_mode) ? "a folder" : "a pipe or device");
}

}  // namespace

LockedFile::LockedFile(std::string path) : path_(std::move(path)) {
  check_file_name(path_);
  struct stat status {};
  // Before it is opened, which some devices take for a command.
  if (::stat(path_.c_str(), &status) == 0) check_regular(path_, status);
  constexpr mode_t kMode = 0666;  // less the umask, like any other file
  while (true) {
    file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NONBLOCK, kMode);
    if (file_ < 0) fail(errno);
    try {
      if (::fstat(file_, &status) != 0) fail(errno);
      check_regular(path_, status);
      if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
        if (errno == EWOULDBLOCK) throw ConfigError(path_, "file", "one writer at a time", holder_of(status));
        throw ConfigError(path_, "file", "a file system with locks (flock)",
                          std::generic_category().message(errno));
      }
      // Another may have put a new file in its place before the lock was ours.
      if (is_at(path_, status)) return;
    } catch (...) {
      ::close(file_);
      throw;
    }
    ::close(file_);
  }
}

LockedFile::~LockedFile() {
  if (dirty_) ::fsync(file_);
  ::flock(file_, LOCK_UN);  // closing does not, where a fork has the file, too
  ::close(file_);
}

/// @param code  an errno value
void LockedFile::fail(int code) const {
  throw ConfigError(path_, "file", "a file that can be written", std::generic_category().message(code));
}

std::size_t LockedFile::size() const {
  struct stat status {};
  if (::fstat(file_, &status) != 0) fail(errno);
  return static_cast<std::size_t>(status.st_size);
}

void LockedFile::check_place() const {
  struct stat status {};
  if (::fstat(file_, &status) != 0) fail(errno);
  if (is_at(path_, status)) return;
  struct stat now {};
  throw ConfigError(path_, "file", "the file that was opened, at its path as long as it is written",
                    fmt::format("{}: what was added since is lost",
                                ::stat(path_.c_str(), &now) == 0 ? "another in its place" : "none"));
}

std::size_t LockedFile::append(std::string_view bytes) {
  check_place();
  const std::size_t before = size();
  std::size_t written = 0;
  while (written < bytes.size()) {
    const ssize_t count = ::write(file_, bytes.data() + written, bytes.size() - written);
    if (count >= 0) {
      written += static_cast<std::size_t>(count);
    } else if (errno != EINTR) {
      const int code = errno;
      // Only what is ours: whoever does not ask for the lock may have written behind it.
      if (written > 0 && size() == before + written) cut(before, before + written);
      fail(code);
    }
  }
  dirty_ = true;
  if (std::chrono::steady_clock::now() - synced_ > kSyncEvery) sync();
  return before;
}

void LockedFile::cut(std::size_t size, std::size_t expected) {
  if (const std::size_t found = this->size(); found != expected) {
    throw ConfigError(path_, "file", fmt::format("{} bytes, as it was read", expected),
                      fmt::format("{}: another program writes it", found));
  }
  while (::ftruncate(file_, static_cast<off_t>(size)) != 0) {
    if (errno != EINTR) fail(errno);
  }
}

void LockedFile::sync() {
  if (::fsync(file_) != 0) fail(errno);
  dirty_ = false;
  synced_ = std::chrono::steady_clock::now();
}

void check_appendable(const std::string& path) {
  struct stat status {};
  ::stat(path.c_str(), &status) == 0 ? static_cast<void>(LockedFile(path)) : check_writable(path);
}

std::optional<std::string> writer_of(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return std::nullopt;
  std::optional<std::string> writer;
  struct stat status {};
  if (::fstat(file, &status) == 0 && S_ISREG(status.st_mode) && ::flock(file, LOCK_SH | LOCK_NB) != 0 &&
      errno == EWOULDBLOCK)
    writer = holder_of(status);
  ::close(file);
  return writer;
}

}  // namespace crossgait
