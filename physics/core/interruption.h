// A signal's wish that the program end, where those who wait can see it.
#pragma once

#include <atomic>

namespace crossgait {

/// Is set by the program's handler of signals. Who waits for something outside looks at it now and then, and
/// throws Interrupted (physics/core/progress.h); where no handler sets it, a signal ends the program itself.
inline std::atomic<bool> interruption_is_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free);  // or a handler could not set it

}  // namespace crossgait
