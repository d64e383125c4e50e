#include "report/page_numbers.h"

#include <bit>
#include <cstddef>

namespace crossgait {
namespace {

nlohmann::ordered_json reference(std::size_t at, std::size_t count) { return {{"at", at}, {"count", count}}; }

}  // namespace

nlohmann::ordered_json PageNumbers::add(std::span<const double> values) {
  const std::size_t at = words_.size();
  for (const double value : values) words_.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(value)));
  return reference(at, values.size());
}

nlohmann::ordered_json PageNumbers::add(std::span<const std::uint32_t> values) {
  const std::size_t at = words_.size();
  words_.insert(words_.end(), values.begin(), values.end());
  return reference(at, values.size());
}

// RFC 4648, section 4.
std::string PageNumbers::base64() const {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::size_t size = 4 * words_.size();
  const auto byte = [&](std::size_t i) { return i < size ? (words_[i / 4] >> (8 * (i % 4))) & 0xffU : 0U; };
  std::string text;
  text.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    const std::uint32_t group = byte(i) << 16U | byte(i + 1) << 8U | byte(i + 2);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > size ? '=' : kDigits[(group >> (18 - 6 * k)) & 63U];
  }
  return text;
}

}  // namespace crossgait
