#include "view/dropped_files.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/atomic_file.h"
#include "physics/core/error.h"
#include "physics/core/text.h"
#include "physics/robot_files/robot_formats.h"

namespace crossgait {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kDroppedSource = "dropped files";
constexpr std::string_view kEnvironmentName = "environment.yaml";

bool is_plain(std::string_view name) {
  constexpr std::size_t kLongest = 200;
  const auto is_harmless = [](char c) { return static_cast<unsigned char>(c) >= 0x20 && c != '\\'; };
  return !name.empty() && name != "." && name != ".." && name.size() <= kLongest &&
         std::all_of(name.begin(), name.end(), is_harmless);
}

void check_paths(const std::vector<DroppedFile>& files) {
  if (files.empty() || files.size() > kMostDroppedFiles)
    throw ConfigError(kDroppedSource, "files", fmt::format("one to {}", kMostDroppedFiles),
                      fmt::format("{}", files.size()));
  for (const DroppedFile& file : files) {
    const auto names = parts_of(file.path, "/");
    if (names.size() > kDeepestDroppedFile || !std::all_of(names.begin(), names.end(), is_plain))
      throw ConfigError(kDroppedSource, "path",
                        fmt::format("plain names, at most {}, with / between them", kDeepestDroppedFile),
                        fmt::format("'{}'", file.path));
    if (in_small_letters(names.back()).ends_with(".xacro"))
      throw ConfigError(kDroppedSource, file.path,
                        "files that run no code: xacro is for the command line (--robot)", "xacro");
  }
}

std::size_t depth_of(const DroppedFile& file) { return parts_of(file.path, "/").size(); }

/// Those that pass a test and lie in the fewest folders: other files of their kind are parts of them.
template <typename Test>
std::vector<const DroppedFile*> outermost(const std::vector<DroppedFile>& files, const Test& test) {
  std::vector<const DroppedFile*> found;
  for (const DroppedFile& file : files) {
    if (!test(file) || (!found.empty() && depth_of(file) > depth_of(*found.front()))) continue;
    if (!found.empty() && depth_of(file) < depth_of(*found.front())) found.clear();
    found.push_back(&file);
  }
  return found;
}

const DroppedFile& the_one(const std::vector<const DroppedFile*>& found, const char* what) {
  if (found.size() == 1) return *found.front();
  std::vector<std::string> paths;
  for (const DroppedFile* file : found) paths.push_back(file->path);
  throw ConfigError(kDroppedSource, what, "one",
                    paths.empty() ? "none" : fmt::format("{}", fmt::join(paths, ", ")));
}

ViewSubject policy_beside(const DroppedFile& environment, const std::vector<DroppedFile>& files) {
  const fs::path folder = fs::path(environment.path).parent_path();
  const auto in_folder = [&](const char* extension) {
    return outermost(files, [&](const DroppedFile& file) {
      const fs::path path(file.path);
      return path.parent_path() == folder && path.extension() == extension &&
             path.filename() != kEnvironmentName;
    });
  };
  std::vector<const DroppedFile*> found = in_folder(".safetensors");
  if (found.empty()) found = in_folder(".yaml");
  return {{},
          the_one(found, "policy beside environment.yaml (NAME.safetensors or NAME.yaml)").path,
          environment.path,
          {}};
}

ViewSubject robot_among(const std::vector<DroppedFile>& files) {
  auto found =
      outermost(files, [](const DroppedFile& file) { return fs::path(file.path).extension() == ".yaml"; });
  if (found.empty()) {
    found = outermost(files, [](const DroppedFile& file) {
      const RobotFormat* format = robot_format_of(file.path);
      return format != nullptr && format->is_robot(file.bytes.substr(0, kBeginning));
    });
  }
  const std::string what =
      fmt::format("robot ({}), or an environment.yaml with its policy", robot_files_in_words());
  return {the_one(found, what.c_str()).path, {}, {}, {}};
}

}  // namespace

ViewSubject keep_dropped(const std::vector<DroppedFile>& files) {
  check_paths(files);
  const auto environments = outermost(
      files, [](const DroppedFile& file) { return fs::path(file.path).filename() == kEnvironmentName; });
  ViewSubject subject = environments.empty()
                            ? robot_among(files)
                            : policy_beside(the_one(environments, "environment.yaml"), files);

  const auto folder = std::make_shared<const TemporaryFolder>("view");
  for (const DroppedFile& file : files) {
    const fs::path path = folder->file(file.path);
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    if (error) throw ConfigError(kDroppedSource, file.path, "a folder that can be made", error.message());
    write_file_atomically(path.string(), file.bytes);
  }
  for (std::string* path : {&subject.robot, &subject.policy, &subject.environment})
    if (!path->empty()) *path = folder->file(*path);
  subject.files = folder;
  return subject;
}

}  // namespace crossgait
