// How far a long job is.
#pragma once

#include <functional>

namespace crossgait {

/// Called now and then with the share of all work done, in [0, 1]; one call at a time, from any thread.
using Progress = std::function<void(double share)>;

}  // namespace crossgait
