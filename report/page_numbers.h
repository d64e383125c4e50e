// The numbers of a page: too many for JSON, which refers to them instead.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace crossgait {

/// Holds numbers of four bytes one behind the other, little endian. What `add` returns, {"at", "count"}, says
/// where they are, counted in numbers. The same numbers are there once, however often they are added: the
/// meshes of one robot in several motions.
class PageNumbers {
 public:
  /// Adds `values` as floats: of 7 digits, more than a picture shows.
  nlohmann::ordered_json add(std::span<const double> values);
  nlohmann::ordered_json add(std::span<const std::uint32_t> values);

  const std::vector<std::uint32_t>& words() const { return words_; }
  std::string base64() const;

 private:
  nlohmann::ordered_json add_words(std::vector<std::uint32_t> words);

  std::vector<std::uint32_t> words_;
  std::unordered_multimap<std::size_t, std::pair<std::size_t, std::size_t>> places_;  // by hash: at, count
};

}  // namespace crossgait
