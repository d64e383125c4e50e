#include "physics/core/temporary_folder.h"

#include <cerrno>
#include <cstdlib>
#include <system_error>

#include "physics/core/error.h"

namespace crossgait {

TemporaryFolder::TemporaryFolder(const std::string& command) {
  std::string path = (std::filesystem::temp_directory_path() / "crossgait-XXXXXX").string();
  if (::mkdtemp(path.data()) == nullptr)
    throw ConfigError(command, path, "a folder that can be made", std::generic_category().message(errno));
  path_ = path;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace crossgait
