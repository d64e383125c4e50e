// The command that a stored result says it was made by.
#pragma once

#include <string>
#include <vector>

#include "apps/results.h"

namespace crossgait::apps {

/// Returns the command and the arguments of a result, as they are typed. The file may be anybody's, so that
/// they make a result and do nothing else is checked by the groups of the options, for every command alike:
/// the command is one that makes results (it has `--json`), and each argument is an option of it that says
/// how a result is made, neither where one goes (kOutputs) nor how it is worked at (kExecution).
/// @param program  with all commands  @throws ConfigError naming the file and the argument
std::vector<std::string> recorded_command(const CLI::App& program, const Recorded& recorded);

}  // namespace crossgait::apps
