// The one exception of configuration: what was wrong, where, what was expected and what was found.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace crossgait {

/// Is thrown by everything that loads or validates input (files, names, specifications). Never thrown by a
/// step. `what()` reads "<source>: <element>: expected <expected>, found <found>"; programs exit with code 2.
/// Of text that is long it keeps the beginning, and control characters stand as `\xNN`.
class ConfigError : public std::runtime_error {
 public:
  /// @param source   file path, option name or specification the input came from
  /// @param element  line, key, link, joint or field inside it
  /// @param expected what would have been right, with its unit
  /// @param found    what was there
  ConfigError(std::string_view source, std::string_view element, std::string_view expected,
              std::string_view found);

  const std::string& source() const noexcept { return source_; }
  const std::string& element() const noexcept { return element_; }
  const std::string& expected() const noexcept { return expected_; }
  const std::string& found() const noexcept { return found_; }

 private:
  std::string source_, element_, expected_, found_;
};

/// Returns foreign text for a terminal: its beginning, at most `most` bytes of whole characters of UTF-8,
/// control characters and bytes that are no UTF-8 as `\xNN`.
std::string printable_text(std::string_view text, std::size_t most);

}  // namespace crossgait
