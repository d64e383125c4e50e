// Where a result comes from: all that it takes to make it again, bit for bit.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "physics/engine/engine.h"
#include "study/version.h"

namespace crossgait {

struct Provenance {
  std::string crossgait = std::string(crossgait_version());
  std::string command;                       ///< of the program, such as "walk"
  std::vector<std::string> arguments;        ///< of that command, but for where results go
  std::map<std::string, std::string> files;  ///< SHA-256 of every file that was read, by its path as shown
  std::vector<EngineInfo> engines;
  nlohmann::json subject;  ///< what was looked at: `to_json(BehaviourSpec)`, `identity_of_robot`; or null
};

/// Adds the files that this thread has read by now, since the innermost FilesRead began: without one none.
/// @throws ConfigError for one that changed meanwhile
Provenance with_files_read(Provenance provenance);

/// Returns the path of a file that a provenance names on this machine: what comes with Crossgait lies
/// elsewhere on another, and is named "<models>/...".
std::string path_of_shown(const std::string& shown);

/// Writes keys as in docs/schemas/README.md; `hash` is that of all others.
nlohmann::ordered_json to_json(const Provenance& provenance);

/// Reads a result as a command's `--json` wrote it. @throws ConfigError if the file is no JSON object, says a
/// key twice, or is beyond kResultBudget
nlohmann::json read_result(const std::string& file);
/// Returns its text, for readers who keep the order of its keys, checked likewise: JSON in order of insertion
/// compares each key with all before it.
std::string read_result_text(const std::string& file);

/// Returns the command and its arguments that a result names. @param result  as a command wrote it
/// @throws ConfigError naming `file` if it names none
std::vector<std::string> command_of(const nlohmann::json& result, const std::string& file);

/// @param recorded  the `provenance` of a result  @throws ConfigError naming `file` and the first key in
/// which the two differ: then what is made now would be another result
void check_same(const nlohmann::json& recorded, const Provenance& now, const std::string& file);

}  // namespace crossgait
