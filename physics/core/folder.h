// What a folder holds, and where it is.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <dirent.h>

#include "physics/core/error.h"

namespace crossgait {

/// Throws ConfigError for a name that the system would take for another: it reads names up to a byte of zero.
inline void check_file_name(const std::string& path) {
  if (path.find('\0') != std::string::npos)
    throw ConfigError(path, "file", "a name without a byte of zero", "one in it");
}

/// Returns the path from the root. @throws ConfigError where the current folder, from which it is, was
/// removed
inline std::filesystem::path absolute_path(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::path whole = std::filesystem::absolute(path, error);
  if (error)
    throw ConfigError(path.string(), "file", "a current folder that is there", "one that was removed");
  return whole;
}

/// Returns the names of what lies in a folder, in no order, without "." and ".."; none of a folder that
/// cannot be read. Unlike std::filesystem::directory_iterator it throws where there is no memory, and does
/// not end the program.
inline std::vector<std::string> names_in_folder(const std::string& folder) {
  struct Close {
    void operator()(DIR* directory) const { ::closedir(directory); }
  };
  std::vector<std::string> names;
  const std::unique_ptr<DIR, Close> directory(::opendir(folder.empty() ? "." : folder.c_str()));
  while (directory != nullptr) {
    const dirent* const entry = ::readdir(directory.get());
    if (entry == nullptr) break;
    std::string name = &entry->d_name[0];
    if (name != "." && name != "..") names.push_back(std::move(name));
  }
  return names;
}

}  // namespace crossgait
