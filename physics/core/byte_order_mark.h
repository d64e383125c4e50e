// The mark that spreadsheets and editors put in front of a text.
#pragma once

#include <string_view>

namespace crossgait {

/// Returns the text behind a byte-order mark of UTF-8; all of it if it has none.
inline std::string_view without_byte_order_mark(std::string_view text) noexcept {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

}  // namespace crossgait
