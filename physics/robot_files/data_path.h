// Where the robots and terrains that come with Crossgait are.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#ifndef CROSSGAIT_MODELS_DIR
#include "physics/robot_files/installed_models.h"  // written by the installation
#endif

namespace crossgait {

/// Returns the folder of the models that come with Crossgait, the first of these that exists:
///  1. the environment variable CROSSGAIT_DATA, which must then name a folder;
///  2. share/crossgait/models beside the library that this is linked into: the Python package's;
///  3. the installed folder as seen from the running program: PREFIX/bin/../share/crossgait/models;
///  4. `built_in`: models/ of the source tree within this project's build, the installed folder in a program
///  that
///     was compiled against an installed Crossgait. CMake's target crossgait::physics defines it; without
///     CMake the installed headers do.
/// @throws ConfigError naming what was looked at
std::string models_dir(std::string_view built_in = CROSSGAIT_MODELS_DIR);

/// Lists the names of the robots in `models_dir()`/robots (folders that hold a robot.yaml), sorted.
std::vector<std::string> robot_names(std::string_view built_in = CROSSGAIT_MODELS_DIR);

/// Tells whether `text` is the path of a robot's file rather than a name: it ends in .yaml, or as a file of a
/// format does (robot_formats.h).
bool is_robot_file(std::string_view text);

/// Returns the file to give to `load_robot`: `text` itself if it is the path of one, else robot.yaml of the
/// robot of that name; else that of an installed package (installed_robots.h). @throws ConfigError listing
/// the bundled names
std::string find_robot(std::string_view text, std::string_view built_in = CROSSGAIT_MODELS_DIR);

}  // namespace crossgait
