#include "physics/core/left_over.h"

#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace crossgait {

void remove_unless_held(const std::filesystem::path& path,
                        bool (*is_ours)(const std::filesystem::path& path, const struct stat& status)) {
  const int file = ::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return;
  struct stat status {};
  std::error_code ignored;
  if (::fstat(file, &status) == 0 && is_ours(path, status) && ::flock(file, LOCK_EX | LOCK_NB) == 0)
    std::filesystem::remove_all(path, ignored);
  ::close(file);
}

}  // namespace crossgait
