// A folder for what another program hands over, gone at the end.
#pragma once

#include <filesystem>
#include <string>

namespace crossgait {

class TemporaryFolder {
 public:
  /// Makes one for its owner alone. @throws ConfigError naming `command`
  explicit TemporaryFolder(const std::string& command);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  TemporaryFolder(TemporaryFolder&&) = delete;
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;

  /// Returns the path of a file in it.
  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

}  // namespace crossgait
