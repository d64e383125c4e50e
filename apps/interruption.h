// Ctrl-C and `kill` end a long command early, with what is done up to then written.
#pragma once

#include <stdexcept>
#include <string>

namespace crossgait::apps {

inline constexpr int kInterruptedExit = 130;  // 128 + SIGINT, as shells have it

/// Remembers the first SIGINT, SIGTERM or SIGHUP (a terminal that was closed) from now on; the second ends
/// the program as usual. A signal that the program was started to ignore stays ignored.
void listen_for_interruption();
/// @throws Interrupted (physics/core/progress.h) if there was one
void check_interruption();

/// Is thrown by a command whose job was interrupted, after what is done was written.
class EndedEarly : public std::runtime_error {
 public:
  /// @param what  how far it came, and what is kept
  explicit EndedEarly(const std::string& what) : std::runtime_error("interrupted: " + what) {}
};

}  // namespace crossgait::apps
