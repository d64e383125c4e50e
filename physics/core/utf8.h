// Text in UTF-8, as RFC 3629 has it: no overlong forms, no halves of surrogate pairs.
#pragma once

#include <cstddef>
#include <string_view>

namespace crossgait {

/// Returns how many bytes the character has that a text begins with, 1 to 4; 0 if it begins with none.
std::size_t utf8_character(std::string_view text) noexcept;

/// Returns how many bytes at the beginning of a text are whole characters: all of them, if it is UTF-8.
std::size_t utf8_length(std::string_view text) noexcept;

}  // namespace crossgait
