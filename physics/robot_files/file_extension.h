// By what a file's name says which format it has.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace crossgait {

/// Returns a path's extension with its dot, in small letters: Windows and some programs write capitals.
inline std::string lower_extension(std::string_view path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return extension;
}

}  // namespace crossgait
