// Reading text: whole files, and numbers that mean the same in every locale.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "physics/core/read_budget.h"

namespace crossgait {

/// Reads the contents of a regular file. Folders, devices and pipes, which may never end, are refused unread.
/// @throws ConfigError naming the file if it cannot be read, is no regular file, or is larger than the budget
std::string read_text_file(const std::string& path, const ReadBudget& budget);

/// Tells whether a byte of UTF-8 begins a character.
constexpr bool begins_character(char byte) noexcept {
  return (static_cast<unsigned char>(byte) & 0xC0) != 0x80;
}
/// Counts characters of a text in UTF-8.
std::size_t width_of(std::string_view utf8) noexcept;

/// Returns what stands between any of the separators; nothing is left out, and parts may be empty.
std::vector<std::string_view> parts_of(std::string_view text, std::string_view separators);

/// Reads the finite number that the whole of `text` spells, with a decimal point in any locale; empty for
/// anything else.
std::optional<double> parse_number(std::string_view text) noexcept;

/// Reads the whole number from 0 to 2^64 - 1 that the whole of `text` spells; empty for anything else.
std::optional<std::uint64_t> parse_seed(std::string_view text) noexcept;
/// What `parse_seed` takes, in words that follow "expected ".
inline constexpr std::string_view kSeedInWords = "a whole number from 0 to 18446744073709551615";

/// Returns what the JSON library says of an error, without the name of its exception.
std::string_view json_error_text(const std::exception& error) noexcept;

/// Returns text with the letters A to Z small; all else as it is.
std::string in_small_letters(std::string_view text);
/// Tells whether texts are the same but for which of the letters A to Z are capitals.
bool equals_ignoring_case(std::string_view a, std::string_view b) noexcept;

}  // namespace crossgait
