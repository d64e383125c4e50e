#include "crossgait/physics/error.h"

#include <fmt/format.h>

namespace crossgait {

ConfigError::ConfigError(std::string_view source, std::string_view element, std::string_view expected,
                         std::string_view found)
    : std::runtime_error(fmt::format("{}: {}: expected {}, found {}", source, element, expected, found)),
      source_(source),
      element_(element),
      expected_(expected),
      found_(found) {}

}  // namespace crossgait
