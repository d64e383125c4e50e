// Tables of heights in CSV, one line for one row of samples. Private to the terrain part of physics/.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace crossgait {

inline constexpr double kHighestSample = 1e4;  ///< m, either way; more is a mistake, not a landscape

/// Holds the samples of a table.
struct CsvHeights {
  int columns = 0, rows = 0;
  std::vector<float> samples;  ///< m, row by row: the last line of the table first, which has the least y
};

/// Reads a table of numbers, as many in every line. @param path  named in errors
/// @throws ConfigError naming line and column
CsvHeights decode_csv_heights(std::string_view text, const std::string& path);

}  // namespace crossgait
