// Another program, run to its end.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace crossgait {

struct ChildResult {
  int exit_code = 0;  ///< -1 if a signal ended it
  std::string out, errors;
  bool over_limit = false;  ///< ended, by us, since it took longer or wrote more than it may
};

enum class ChildErrors { kKept, kShown };  ///< shown: on this program's own standard error, as they come

/// Says what becomes of a SIGINT, SIGTERM or SIGHUP of this program while it waits for a child. Handed on:
/// the child is given it, unless a terminal has done so itself, and this program acts on it when the child
/// has ended. One such child at a time.
enum class ChildSignals { kLeft, kHandedOn };

/// Bounds what a child may take before it is ended.
struct ChildLimits {
  std::chrono::seconds time;  ///< of the clock, and of the processor
  std::size_t bytes;          ///< of any file that it writes, its output among them, of which no more is read
};

/// Runs a program to its end; it reads nothing. @param command  the program, looked for as a shell does, and
/// its arguments
/// @returns nothing if there is no such program  @throws std::system_error if it cannot be run
std::optional<ChildResult> run_child(const std::vector<std::string>& command,
                                     ChildErrors errors = ChildErrors::kKept,
                                     std::optional<ChildLimits> limits = std::nullopt,
                                     ChildSignals signals = ChildSignals::kLeft);

}  // namespace crossgait
