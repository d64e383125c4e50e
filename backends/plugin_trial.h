// What a plug-in does to the process that opens it is tried in another one first.
#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace crossgait {

/// How long a plug-in may take to be opened before it is refused: far more than large libraries on a slow
/// disk take, little beside waiting for ever.
inline constexpr std::chrono::milliseconds kTrialLimit{10'000};

/// Calls `open` in a fork of this process, whose standard streams lead nowhere.
/// @param open  opens something and says why it cannot be used; nothing if it can
/// @returns what it says, or what became of the fork: that it was ended by a signal or by itself, did not
/// answer in time, or computes otherwise than before. Empty: it may be opened here
/// @throws std::system_error if there can be no fork
std::string try_in_fork(const std::function<std::string()>& open,
                        std::chrono::milliseconds limit = kTrialLimit);

}  // namespace crossgait
