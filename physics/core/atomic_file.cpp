#include "physics/core/atomic_file.h"

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "physics/core/error.h"

namespace crossgait {

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)) {
  struct stat existing {};
  special_ = ::stat(path_.c_str(), &existing) == 0 && !S_ISREG(existing.st_mode);
  // Unique among processes and threads, so that two writers of one file do not meet in the temporary.
  static std::atomic<unsigned> counter{0};
  target_ = special_ ? path_ : fmt::format("{}.{}-{}.tmp", path_, ::getpid(), counter++);
  const int flags = special_ ? O_WRONLY : O_WRONLY | O_CREAT | O_EXCL;
  constexpr mode_t kMode = 0666;  // less the umask, like any other file
  file_ = ::open(target_.c_str(), flags | O_CLOEXEC, kMode);
  if (file_ < 0) {
    target_.clear();
    fail(errno);
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
    } else if (errno != EINTR) {
      fail(errno);
    }
  }
  buffer_.clear();
}

void AtomicFile::commit() {
  flush();
  if (!special_ && ::fsync(file_) != 0) fail(errno);
  if (::close(std::exchange(file_, -1)) != 0) fail(errno);
  if (!special_ && std::rename(target_.c_str(), path_.c_str()) != 0) fail(errno);
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
