#include "physics/core/table.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "physics/core/text.h"

namespace crossgait {
namespace {

// Numbers line up at their right ends, words at their left.
bool is_number(const std::string& cell) {
  constexpr std::string_view kDigits = ".0123456789";
  const std::size_t first = cell.starts_with('+') || cell.starts_with('-') ? 1 : 0;
  return cell == "-" || (cell.size() > first && kDigits.find(cell[first]) != std::string_view::npos);
}

}  // namespace

std::string counted(std::size_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

Table::Table(std::vector<std::string> header) { rows_.push_back(std::move(header)); }

void Table::add_row(std::vector<std::string> cells) {
  cells.resize(rows_.front().size());
  rows_.push_back(std::move(cells));
}

std::string Table::str() const {
  std::vector<std::size_t> widths(rows_.front().size(), 0);
  for (const auto& row : rows_) {
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], width_of(row[c]));
  }
  std::vector<bool> right(widths.size(), false);
  for (std::size_t c = 1; c < widths.size(); ++c) {
    right[c] =
        std::any_of(rows_.begin() + 1, rows_.end(), [c](const auto& row) { return is_number(row[c]); });
  }
  std::string text;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    std::string line;
    for (std::size_t c = 0; c < widths.size(); ++c) {
      const std::string padding(widths[c] - width_of(rows_[r][c]), ' ');
      if (c > 0) line += "  ";
      line += right[c] ? padding + rows_[r][c] : rows_[r][c] + padding;
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
    if (r == 0) {
      std::size_t total = 2 * (widths.size() - 1);
      for (const std::size_t w : widths) total += w;
      text += std::string(total, '-') + "\n";
    }
  }
  return text;
}

}  // namespace crossgait
