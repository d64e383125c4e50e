// Robots' files in Python packages and caches on this machine. Nothing is downloaded.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace crossgait {

struct InstalledRobot {
  std::string name;  ///< of its file, without the extensions
  std::string file;
  std::string from;  ///< the package, or the folder that was searched
};

/// Lists what is in the folders of the environment variable CROSSGAIT_ROBOT_PATH (apart by colons), the cache
/// of robot_descriptions, a mujoco_menagerie in the home folder, and packages with robots among those of the
/// Python on the path, of PYTHONPATH and of the user: files of every format (RobotFormat::is_robot). At most
/// kMostInstalledFiles files and folders of each are looked at.
std::vector<InstalledRobot> installed_robots();
inline constexpr int kMostInstalledFiles = 20'000;

/// Finds the best match of a name, in any case: a file called so; else one in a folder called so, or so with
/// `_description` behind or a maker before it (`unitree_go2`). Of several the first of the list, but a xacro
/// last.
std::optional<InstalledRobot> find_installed_robot(std::string_view name);

}  // namespace crossgait
