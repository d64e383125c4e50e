#include "crossgait/physics/atomic_file.h"

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "crossgait/physics/error.h"

namespace crossgait {
namespace {

/// @param code  an errno value
[[noreturn]] void fail(const std::string& path, int code) {
  throw ConfigError(path, "output file", "a place that can be written",
                    std::generic_category().message(code));
}

/// Writes everything to an open file and closes it. @returns 0 or an errno value
int write_and_close(int file, std::string_view bytes, bool sync) {
  int code = 0;
  while (code == 0 && !bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      code = errno;
    }
  }
  if (code == 0 && sync && ::fsync(file) != 0) code = errno;
  if (::close(file) != 0 && code == 0) code = errno;
  return code;
}

}  // namespace

void write_file_atomically(const std::string& path, std::string_view bytes) {
  struct stat existing {};
  const bool special = ::stat(path.c_str(), &existing) == 0 && !S_ISREG(existing.st_mode);
  // Unique among processes and threads, so that two writers of one file do not meet in the temporary.
  static std::atomic<unsigned> counter{0};
  const std::string target = special ? path : fmt::format("{}.{}-{}.tmp", path, ::getpid(), counter++);
  const int flags = special ? O_WRONLY : O_WRONLY | O_CREAT | O_EXCL;
  constexpr mode_t kMode = 0666;  // less the umask, like any other file
  const int file = ::open(target.c_str(), flags | O_CLOEXEC, kMode);
  if (file < 0) fail(path, errno);
  int code = write_and_close(file, bytes, !special);
  if (special) {
    if (code != 0) fail(path, code);
    return;
  }
  if (code == 0 && std::rename(target.c_str(), path.c_str()) != 0) code = errno;
  if (code != 0) {
    ::unlink(target.c_str());
    fail(path, code);
  }
}

}  // namespace crossgait
