// Opens engines' plug-ins (physics/engine/engine_plugin.h) and says why one cannot be used.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "backends/plugin_trial.h"
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
/// found another library than its headers'. Opening a file runs its code in this process. One that did not
/// come with the program is opened in a fork of it first, so that what damaged or careless code does when it
/// is opened (a signal, `exit`, waiting for ever) refuses it, and does not end the program; what it does
/// later nobody can refuse.
/// @param limit  time that it may take there
LoadedPlugin load_plugin(const std::string& file, std::chrono::milliseconds limit = kTrialLimit);

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
