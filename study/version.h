// Which Crossgait this is.
#pragma once

#include <string_view>

namespace crossgait {

/// Returns the version of this build, as `crossgait --version` prints it.
std::string_view crossgait_version() noexcept;

}  // namespace crossgait
