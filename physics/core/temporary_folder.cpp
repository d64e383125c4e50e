#include "physics/core/temporary_folder.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "physics/core/error.h"
#include "physics/core/folder.h"
#include "physics/core/left_over.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

/// Tells of "crossgait-1234-aBcD12".
bool is_ours(std::string_view name) {
  constexpr std::string_view kBeginning = "crossgait-";
  constexpr std::size_t kRandom = 6;  // of mkdtemp
  if (!name.starts_with(kBeginning)) return false;
  name.remove_prefix(kBeginning.size());
  const std::size_t dash = name.find_first_not_of("0123456789");
  return dash != 0 && dash != std::string_view::npos && name[dash] == '-' &&
         name.size() - dash - 1 == kRandom &&
         std::all_of(name.begin() + static_cast<std::ptrdiff_t>(dash) + 1, name.end(),
                     [](unsigned char c) { return std::isalnum(c) != 0; });
}

/// Removes folders of programs that are gone. What is in them is ours to remove, links as links.
void remove_left_folders(const fs::path& among) {
  for (const std::string& name : names_in_folder(among.string())) {
    if (!is_ours(name)) continue;
    remove_unless_held(among / name, [](const fs::path&, const struct stat& status) {
      return S_ISDIR(status.st_mode) && status.st_uid == ::geteuid();
    });
  }
}

}  // namespace

fs::path temporary_root(const std::string& source) {
  std::error_code error;
  fs::path root = fs::temp_directory_path(error);
  const char* named = std::getenv("TMPDIR");  // NOLINT(concurrency-mt-unsafe): nothing here sets it
  if (error)
    throw ConfigError(source, "TMPDIR", "a folder for temporary files", named == nullptr ? "none" : named);
  return root;
}

TemporaryFolder::TemporaryFolder(const std::string& command) {
  remove_left_folders(temporary_root(command));
  while (!make(command)) {
  }
}

bool TemporaryFolder::make(const std::string& command) {
  std::string path = (temporary_root(command) / fmt::format("crossgait-{}-XXXXXX", ::getpid())).string();
  if (::mkdtemp(path.data()) == nullptr)
    throw ConfigError(command, path, "a folder that can be made", std::generic_category().message(errno));
  path_ = path;
  lock_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  // Whoever removes what is left over may have had the lock first.
  ::flock(lock_, LOCK_SH);
  std::error_code error;
  if (fs::exists(path_, error)) return true;
  ::close(lock_);
  return false;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  if (lock_ >= 0) ::close(lock_);
}

}  // namespace crossgait
