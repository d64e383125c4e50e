#include "crossgait/physics/text.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>

#include "crossgait/physics/error.h"

namespace crossgait {

std::string read_text_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  // A directory opens but cannot be read: peek tells the two apart from an empty file.
  if (file) file.peek();
  if (!file && !file.eof()) throw ConfigError(path, "file", "a readable file", "none");
  file.clear();
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::optional<double> parse_number(std::string_view text) noexcept {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    if (text.starts_with('-')) return std::nullopt;
  }
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace crossgait
