#include "physics/robot_files/mesh/mesh_path.h"

#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include "physics/core/text.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestPath = 4096;  // bytes, Linux's own

/// Folders that a variable of the environment lists.
void add_folders_of(const char* variable, std::string_view below, std::vector<std::string>& folders) {
  const char* list = std::getenv(variable);
  for (const std::string_view folder : parts_of(list == nullptr ? "" : list, ":"))
    if (!folder.empty()) folders.push_back((fs::path(folder) / below).string());
}

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

}  // namespace

std::vector<std::string> named_file_folders(const std::string& named_in) {
  std::vector<std::string> folders;
  std::error_code error;
  fs::path folder = fs::absolute(named_in, error).lexically_normal().parent_path();
  for (;; folder = folder.parent_path()) {
    folders.push_back(folder.string());
    if (folder == folder.parent_path()) break;
  }
  for (const char* variable :
       {"CROSSGAIT_PACKAGE_PATH", "ROS_PACKAGE_PATH", "GZ_SIM_RESOURCE_PATH", "GAZEBO_MODEL_PATH"})
    add_folders_of(variable, "", folders);
  add_folders_of("AMENT_PREFIX_PATH", "share", folders);
  return folders;
}

std::optional<std::string> find_named_file(const std::string& filename, const std::string& named_in) {
  if (filename.size() > kLongestPath) return std::nullopt;
  std::string path = filename;
  bool in_package = false;
  for (const std::string_view scheme : {"file://", "package://", "model://"}) {
    if (!filename.starts_with(scheme)) continue;
    path = filename.substr(scheme.size());
    in_package = scheme != "file://";
  }
  if (!in_package && fs::path(path).is_absolute()) {
    return is_file(path) ? std::optional(path) : std::nullopt;
  }
  std::vector<std::string> wanted{path};
  if (const std::size_t slash = path.find('/'); in_package && slash != std::string::npos) {
    wanted.push_back(path.substr(slash + 1));
  }
  for (const fs::path folder : named_file_folders(named_in)) {
    for (const std::string& name : wanted) {
      // Relative, whatever it begins with: a/ + /b would be /b.
      const fs::path candidate = folder / fs::path(name).relative_path();
      if (is_file(candidate)) return candidate.lexically_normal().string();
    }
  }
  return std::nullopt;
}

}  // namespace crossgait
