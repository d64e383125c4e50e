// What a folder holds.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <dirent.h>

namespace crossgait {

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
