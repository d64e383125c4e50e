#include "physics/core/error.h"

#include <algorithm>

#include <fmt/format.h>

#include "physics/core/utf8.h"

namespace crossgait {
namespace {

// An error says where to look; it does not print the file. Lists of known names are the longest that help.
constexpr std::size_t kMostQuoted = 500, kMostPath = 4096, kMostExpected = 8192;

/// Whether a character of UTF-8 turns the direction of what follows it, so that a line reads as another.
bool turns_direction(std::string_view character) {
  return character == "\u061c" || (character >= "\u200e" && character <= "\u200f") ||
         (character >= "\u202a" && character <= "\u202e") || (character >= "\u2066" && character <= "\u2069");
}

/// Bytes of the character of UTF-8 that `text` begins with; 0 if it begins with none, with a control
/// character (of C0 or C1, or delete), since some terminals take U+009B for the beginning of a command, or
/// with one that turns the direction of text.
std::size_t printable(std::string_view text) {
  const std::size_t length = utf8_character(text);
  if (length == 0) return 0;
  const auto lead = static_cast<unsigned char>(text.front());
  const bool is_control = length == 1 ? (lead < 0x20 && lead != '\n' && lead != '\t') || lead == 0x7f
                                      : lead == 0xC2 && static_cast<unsigned char>(text[1]) < 0xA0;
  return is_control || turns_direction(text.substr(0, length)) ? 0 : length;
}

// Where it is: of a name with an end of line in it, two lines would look like two errors.
std::string one_line(std::string_view text, std::size_t most) {
  std::string line = printable_text(text, most);
  for (std::size_t at = 0; (at = line.find('\n', at)) != std::string::npos;) line.replace(at, 1, "\\x0a");
  return line;
}

}  // namespace

std::string printable_text(std::string_view text, std::size_t most) {
  std::string result;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t length = printable(text.substr(at));
    const std::size_t bytes = std::max<std::size_t>(length, 1);
    if (at + bytes > most) break;
    result += length == 0 ? fmt::format("\\x{:02x}", static_cast<unsigned char>(text[at]))
                          : std::string(text.substr(at, length));
    at += bytes;
  }
  if (at < text.size()) result += fmt::format("... ({} bytes in all)", text.size());
  return result;
}

ConfigError::ConfigError(std::string_view source, std::string_view element, std::string_view expected,
                         std::string_view found)
    : std::runtime_error(fmt::format("{}: {}: expected {}, found {}", one_line(source, kMostPath),
                                     one_line(element, kMostQuoted), printable_text(expected, kMostExpected),
                                     printable_text(found, kMostQuoted))),
      source_(one_line(source, kMostPath)),
      element_(one_line(element, kMostQuoted)),
      expected_(printable_text(expected, kMostExpected)),
      found_(printable_text(found, kMostQuoted)) {}

}  // namespace crossgait
