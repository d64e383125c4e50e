#include "physics/robot_files/mesh/mesh_path.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <iterator>
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

/// Undoes the escapes of a URI: "%20" is a blank. What is no escape, or the end of a name in C, stays.
std::string unescaped(const std::string& uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned code = 0;
    const char *first = uri.data() + i + 1, *last = first + 2;
    const bool is_escape = uri[i] == '%' && i + 2 < uri.size() &&
                           std::from_chars(first, last, code, 16).ptr == last && code != 0;
    text += is_escape ? static_cast<char>(code) : uri[i];
    if (is_escape) i += 2;
  }
  return text;
}

/// A name as a file means it.
struct MeantPath {
  std::string path;         ///< without the scheme
  bool is_uri = false;      ///< there was a scheme
  bool in_package = false;  ///< it begins with a package
};

MeantPath meant_by(const std::string& filename) {
  for (const std::string_view scheme : {"file://", "package://", "model://", "file:/"}) {
    if (!filename.starts_with(scheme)) continue;
    const bool is_short = scheme == "file:/";  // whose slash is the path's
    return {filename.substr(scheme.size() - (is_short ? 1 : 0)), true, !scheme.starts_with("file:")};
  }
  return {filename};
}

/// Where it may be in a folder: as it is, and of PACKAGE/REST also REST, and without its "..".
std::vector<std::string> places_of(const std::string& path, bool in_package) {
  std::vector<std::string> places{path};
  const std::size_t slash = path.find('/');
  if (!in_package || slash == std::string::npos) return places;
  places.push_back(path.substr(slash + 1));
  places.push_back(fs::path(path).lexically_normal().string());
  return places;
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
  const MeantPath meant = meant_by(filename);
  std::vector<std::string> wanted;
  std::vector<std::string> paths{meant.path};
  if (meant.is_uri && meant.path.find('%') != std::string::npos) paths.push_back(unescaped(meant.path));
  for (const std::string& path : paths) {
    if (!meant.in_package && fs::path(path).is_absolute()) {
      if (is_file(path)) return path;
    } else {
      std::ranges::move(places_of(path, meant.in_package), std::back_inserter(wanted));
    }
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
