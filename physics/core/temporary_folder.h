// A folder for what another program hands over, gone at the end.
#pragma once

#include <filesystem>
#include <string>

namespace crossgait {

/// Returns the folder of temporary files. @throws ConfigError naming `source` if there is none
std::filesystem::path temporary_root(const std::string& source);

/// Makes a folder among temporary files, crossgait-PID-XXXXXX, for its owner alone, and removes it at its
/// end.
///
/// A program that was killed leaves its folder. The next that makes one removes those of the same user whose
/// lock (`flock`) nobody holds; where a file system has no locks on folders, nothing is removed.
class TemporaryFolder {
 public:
  /// @throws ConfigError naming `command`
  explicit TemporaryFolder(const std::string& command);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  TemporaryFolder(TemporaryFolder&&) = delete;
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;

  /// Returns the path of a file in it.
  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  /// Makes a folder and takes its lock. @returns whether it is there still
  bool make(const std::string& command);

  std::filesystem::path path_;
  int lock_ = -1;  ///< the folder, open: says that its owner lives
};

}  // namespace crossgait
