// The one thing that a caller of spans can get wrong.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "physics/core/error.h"

namespace crossgait {

/// @throws ConfigError naming `source` and `what` unless `found` numbers are as many as `expected`
inline void check_size(std::string_view source, std::string_view what, std::size_t found,
                       std::size_t expected) {
  if (found != expected)
    throw ConfigError(source, what, std::to_string(expected) + " numbers", std::to_string(found));
}

}  // namespace crossgait
