// Another program, run to its end.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace crossgait::apps {

struct ChildResult {
  int exit_code = 0;  ///< -1 if a signal ended it
  std::string out, errors;
};

/// Is thrown where a child has said itself what went wrong: its exit code becomes this program's.
struct ChildFailed {
  int exit_code = 1;
};

enum class ChildErrors { kKept, kShown };  ///< shown: on this program's own standard error, as they come

/// Runs a program to its end; it reads nothing. @param command  the program, looked for as a shell does, and
/// its arguments
/// @returns nothing if there is no such program  @throws std::system_error if it cannot be run
std::optional<ChildResult> run_child(const std::vector<std::string>& command,
                                     ChildErrors errors = ChildErrors::kKept);

}  // namespace crossgait::apps
