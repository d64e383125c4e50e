// Lines and words of a mesh that is written as text.
#pragma once

#include <algorithm>
#include <string_view>

namespace crossgait {

/// Takes the first line off a text, without its end: LF, CRLF or CR alone, as systems have them.
inline std::string_view take_line(std::string_view& text) {
  const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
  text.remove_prefix(line.size());
  text.remove_prefix(text.starts_with("\r\n") ? 2 : text.empty() ? 0 : 1);
  return line;
}

/// Takes the first word off a text, which is empty if there is none.
inline std::string_view take_word(std::string_view& text) {
  constexpr std::string_view kSpace = " \t\r\n\v\f";
  text.remove_prefix(std::min(text.find_first_not_of(kSpace), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(kSpace));
  text.remove_prefix(word.size());
  return word;
}

}  // namespace crossgait
