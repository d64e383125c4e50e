// By what a file's name says which format it has.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "physics/core/text.h"

namespace crossgait {

/// Returns a path's extension with its dot, in small letters: Windows and some programs write capitals.
inline std::string lower_extension(std::string_view path) {
  return in_small_letters(std::filesystem::path(path).extension().string());
}

}  // namespace crossgait
