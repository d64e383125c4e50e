#include "physics/robot_files/data_path.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include <dlfcn.h>
#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/find_row.h"
#include "physics/robot_files/file_extension.h"
#include "physics/robot_files/installed_robots.h"
#include "physics/robot_files/robot_formats.h"

namespace crossgait {
namespace fs = std::filesystem;
namespace {

/// CROSSGAIT_MODELS_FROM_PROGRAM (e.g. ../share/crossgait/models) from the folder of the running program.
fs::path models_beside_program() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return error ? fs::path() : (program.parent_path() / CROSSGAIT_MODELS_FROM_PROGRAM).lexically_normal();
}

/// share/crossgait/models beside the library that this code was linked into.
fs::path models_beside_library() {
  Dl_info library{};
  if (dladdr(reinterpret_cast<const void*>(&models_beside_library), &library) == 0) return {};
  std::error_code error;
  const fs::path file = fs::canonical(library.dli_fname, error);
  return error ? fs::path() : file.parent_path() / "share/crossgait/models";
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

}  // namespace

std::string models_dir(std::string_view built_in) {
  if (const char* given = std::getenv("CROSSGAIT_DATA"); given != nullptr) {
    if (!is_folder(given)) {
      throw ConfigError("environment", "CROSSGAIT_DATA", "a folder of robots and terrains",
                        fmt::format("'{}'", given));
    }
    return given;
  }
  if (const fs::path packaged = models_beside_library(); is_folder(packaged)) return packaged.string();
  const fs::path installed = models_beside_program();
  if (is_folder(installed)) return installed.string();
  if (is_folder(built_in)) return std::string(built_in);
  throw ConfigError("models", "folder",
                    fmt::format("one of '{}', '{}', or the environment variable CROSSGAIT_DATA",
                                installed.string(), built_in),
                    "none of them");
}

std::vector<std::string> robot_names(std::string_view built_in) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(fs::path(models_dir(built_in)) / "robots", error)) {
    if (fs::exists(entry.path() / "robot.yaml", error)) names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

bool is_robot_file(std::string_view text) {
  return lower_extension(text) == ".yaml" || robot_format_of(text) != nullptr;
}

std::string find_robot(std::string_view text, std::string_view built_in) {
  const fs::path path(text);
  if (is_robot_file(text)) return path.string();
  const std::vector<std::string> names = robot_names(built_in);
  if (std::find(names.begin(), names.end(), text) == names.end()) {
    if (const auto installed = find_installed_robot(text)) return installed->file;
    fail_unknown_name(text, names, "robot", "name",
                      fmt::format(", one of those that `crossgait robots --list` finds, or a {} file",
                                  robot_files_in_words()));
  }
  return (fs::path(models_dir(built_in)) / "robots" / path / "robot.yaml").string();
}

}  // namespace crossgait
