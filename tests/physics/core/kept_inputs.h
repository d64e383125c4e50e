// What tests write for readers, kept for those who look for more (scripts/quality/coverage-fuzz).
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>

namespace crossgait {

/// Keeps a copy of a file of a test in the folder CROSSGAIT_KEEP_INPUTS, once whatever tests write it.
/// Without that variable it does nothing.
inline void keep_input(const std::string& name, std::string_view bytes) {
  const char* const folder = std::getenv("CROSSGAIT_KEEP_INPUTS");
  if (folder == nullptr) return;
  const std::string file = std::to_string(std::hash<std::string_view>()(bytes)) + "-" +
                           std::filesystem::path(name).filename().string();
  std::ofstream(std::filesystem::path(folder) / file, std::ios::binary) << bytes;
}

}  // namespace crossgait
