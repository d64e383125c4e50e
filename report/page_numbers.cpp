#include "report/page_numbers.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <functional>
#include <string_view>

namespace crossgait {
namespace {

std::size_t hash_of(std::span<const std::uint32_t> words) {
  const auto bytes = std::as_bytes(words);
  return std::hash<std::string_view>()({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace

nlohmann::ordered_json PageNumbers::add(std::span<const double> values) {
  std::vector<std::uint32_t> words;
  words.reserve(values.size());
  for (const double value : values) words.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(value)));
  return add_words(std::move(words));
}

nlohmann::ordered_json PageNumbers::add(std::span<const std::uint32_t> values) {
  return add_words({values.begin(), values.end()});
}

nlohmann::ordered_json PageNumbers::add_words(std::vector<std::uint32_t> words) {
  const std::size_t hash = hash_of(words);
  const auto [first, last] = places_.equal_range(hash);
  for (auto known = first; known != last; ++known) {
    const auto [at, count] = known->second;
    if (count == words.size() &&
        std::equal(words.begin(), words.end(), words_.begin() + static_cast<std::ptrdiff_t>(at)))
      return {{"at", at}, {"count", count}};
  }
  const std::size_t at = words_.size();
  words_.insert(words_.end(), words.begin(), words.end());
  places_.emplace(hash, std::pair(at, words.size()));
  return {{"at", at}, {"count", words.size()}};
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
