// Opens engines' plug-ins (physics/engine/engine_plugin.h) and says why one cannot be used.
#pragma once

#include <string>
#include <vector>

#include "physics/engine/engine_plugin.h"

namespace crossgait {

/// Holds a file and what came of opening it. What was opened stays so for the life of the process.
struct LoadedPlugin {
  std::string file;                      ///< with links resolved
  const EnginePlugin* plugin = nullptr;  ///< null if it was refused
  std::string reason;                    ///< why it was
};

/// Opens one file with symbols of its own: two engines, or two versions of one, may carry the same symbols.
/// Refuses what is no regular file, is cut off, is no plug-in, was built for another interface, throws, or
/// found another library than its headers'. Opening a file runs its code in this process: what that code does
/// to it, by giving an address at which nothing is or by never returning, nobody can refuse.
LoadedPlugin load_plugin(const std::string& file);

/// Lists the folders in which plug-ins are looked for:
///  1. those that the environment variable CROSSGAIT_ENGINE_PATH lists, separated by colons;
///  2. those in which the program or shared library that this code is in finds its libraries: its run path
///     leads to the engines that come with Crossgait (the CMake target crossgait::backends sets it).
/// @throws ConfigError if CROSSGAIT_ENGINE_PATH lists what is no folder
std::vector<std::string> plugin_folders();

/// Lists files libcrossgait_engine_*.so in these folders by folder, then by name, links resolved, each once.
std::vector<std::string> plugin_files(const std::vector<std::string>& folders);

/// Returns "mujoco" of ".../libcrossgait_engine_mujoco.so".
std::string plugin_name(const std::string& file);

}  // namespace crossgait
