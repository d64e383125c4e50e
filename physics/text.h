// Reading text: whole files, and numbers that mean the same in every locale.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace crossgait {

/// Contents of a text file. @throws ConfigError if it cannot be read
std::string read_text_file(const std::string& path);

/// The finite number that the whole of `text` spells, with a decimal point in any locale; empty for anything
/// else.
std::optional<double> parse_number(std::string_view text) noexcept;

}  // namespace crossgait
