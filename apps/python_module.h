// Modules of Crossgait's Python package, which some commands run.
#pragma once

#include <string>
#include <vector>

#include "physics/core/child_process.h"

namespace crossgait::apps {

/// Is thrown where a child has said itself what went wrong: its exit code becomes this program's.
struct ChildFailed {
  int exit_code = 1;
};

/// Checks that `module` can be imported; call it before a command does anything. @param extra  of the
/// package, which brings what the module takes
/// @throws ConfigError naming `command` and what to install, unless that Python has the module
void require_python_module(const std::string& command, const std::string& module, const std::string& extra);

/// Runs `python -m module` to its end; a SIGINT or SIGTERM ends it first, and then this program.
/// @throws ChildFailed if it does not end well, having said itself why  @throws Interrupted
ChildResult run_python_module(const std::string& module, const std::vector<std::string>& arguments);

}  // namespace crossgait::apps
