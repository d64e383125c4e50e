#include "crossgait/physics/error.h"

#include <algorithm>

#include <fmt/format.h>

namespace crossgait {
namespace {

// An error says where to look; it does not print the file. Lists of known names are the longest that help.
constexpr std::size_t kMostQuoted = 500, kMostPath = 4096, kMostExpected = 8192;

/// Foreign text for a terminal: its beginning, on a whole character of UTF-8, control characters as \xNN.
std::string shown(std::string_view text, std::size_t most) {
  std::size_t end = std::min(text.size(), most);
  const auto continues = [&](std::size_t at) {
    return at > 0 && at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;
  };
  while (continues(end)) --end;
  std::string result;
  for (const char c : text.substr(0, end)) {
    const auto byte = static_cast<unsigned char>(c);
    const bool control = (byte < 0x20 && c != '\n' && c != '\t') || byte == 0x7f;
    result += control ? fmt::format("\\x{:02x}", byte) : std::string(1, c);
  }
  if (end < text.size()) result += fmt::format("... ({} bytes in all)", text.size());
  return result;
}

}  // namespace

ConfigError::ConfigError(std::string_view source, std::string_view element, std::string_view expected,
                         std::string_view found)
    : std::runtime_error(fmt::format("{}: {}: expected {}, found {}", shown(source, kMostPath),
                                     shown(element, kMostQuoted), shown(expected, kMostExpected),
                                     shown(found, kMostQuoted))),
      source_(shown(source, kMostPath)),
      element_(shown(element, kMostQuoted)),
      expected_(shown(expected, kMostExpected)),
      found_(shown(found, kMostQuoted)) {}

}  // namespace crossgait
