#include "physics/terrain/csv_heights.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "physics/core/byte_order_mark.h"
#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "physics/core/text.h"
#include "physics/terrain/height_field.h"
#include "physics/terrain/terrain_parameters.h"

namespace crossgait {
namespace {

/// Appends the lines of a table value by value.
class CsvReader {
 public:
  CsvReader(const std::string& path, std::string_view text)
      : path_(path), rest_(without_byte_order_mark(text)) {
    if (rest_.empty()) throw ConfigError(path_, "line 1", "comma-separated heights in m", "an empty file");
    // As many values as there can be: growing by doubling would need twice the memory.
    const auto commas = std::count(rest_.begin(), rest_.end(), ',');
    const auto lines = std::count(rest_.begin(), rest_.end(), '\n');
    if (commas >= kMaxHeightSamples) {
      throw ConfigError(path_, "file", fmt::format("at most {} values", kMaxHeightSamples), "more");
    }
    heights_.reserve(
        static_cast<std::size_t>(std::min<std::int64_t>(commas + lines + 1, kMaxHeightSamples + 1)));
    while (!rest_.empty()) read_line();
  }

  /// Leaves nothing behind.
  CsvHeights take() {
    const auto row = [this](int index) { return heights_.begin() + std::ptrdiff_t{index} * columns_; };
    for (int r = 0; r < rows_ / 2; ++r) std::swap_ranges(row(r), row(r + 1), row(rows_ - 1 - r));
    return {columns_, rows_, std::move(heights_)};
  }

 private:
  void read_line() {
    const std::size_t end = rest_.find('\n');
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    ++rows_;
    int count = 0;
    while (true) {
      const std::size_t comma = line.find(',');
      heights_.push_back(parse(line.substr(0, comma), ++count));
      if (static_cast<std::int64_t>(heights_.size()) > kMaxHeightSamples) {
        throw ConfigError(path_, fmt::format("line {}", rows_),
                          fmt::format("at most {} values", kMaxHeightSamples), "more");
      }
      if (comma == std::string_view::npos) break;
      line.remove_prefix(comma + 1);
    }
    if (rows_ == 1) columns_ = count;
    if (count != columns_) {
      throw ConfigError(path_, fmt::format("line {}", rows_),
                        fmt::format("{} values, as in line 1", columns_), std::to_string(count));
    }
  }

  float parse(std::string_view cell, int column) const {
    constexpr std::string_view kBlank = " \t";
    std::string_view text = cell.substr(std::min(cell.find_first_not_of(kBlank), cell.size()));
    text = text.substr(0, text.find_last_not_of(kBlank) + 1);
    const std::optional<double> value = parse_number(text);
    if (!value || std::abs(*value) > kHighestSample) {
      throw ConfigError(path_, fmt::format("line {}, column {}", rows_, column),
                        fmt::format("a height in [{}, {}] m", -kHighestSample, kHighestSample),
                        text.empty() ? "nothing" : quoted(text));
    }
    return static_cast<float>(*value);
  }

  const std::string& path_;
  std::string_view rest_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<float> heights_;
};

}  // namespace

CsvHeights decode_csv_heights(std::string_view text, const std::string& path) {
  return CsvReader(path, text).take();
}

}  // namespace crossgait
