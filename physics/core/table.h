// Plain-text tables: columns with numbers are right-aligned, the first column and columns of words
// left-aligned.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace crossgait {

/// Counts things: "1 episode", "3 episodes". @param noun  whose plural ends in s
std::string counted(std::size_t count, std::string_view noun);

class Table {
 public:
  explicit Table(std::vector<std::string> header);
  /// @param cells as many as the header has, or fewer
  void add_row(std::vector<std::string> cells);
  /// Writes lines, each with its end; a rule separates header and rows. Widths count characters of UTF-8.
  std::string str() const;
  /// Returns the rows, the header first.
  const std::vector<std::vector<std::string>>& rows() const noexcept { return rows_; }

 private:
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace crossgait
