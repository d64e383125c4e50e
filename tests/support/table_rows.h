// A plain-text table (physics/core/table.h) read back: what its cells say, however wide they are.
#pragma once

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

namespace crossgait {

using Cells = std::vector<std::string>;

/// Reads the rows of every table in `text`, and any other lines, cell by cell, without rules and empty lines.
/// Cells are what stands apart by two spaces or more, so that empty ones are left out.
inline std::vector<Cells> table_rows(const std::string& text) {
  std::vector<Cells> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.find_first_not_of("- ") == std::string::npos) continue;
    Cells cells;
    for (std::size_t begin = line.find_first_not_of(' '); begin != std::string::npos;) {
      const std::size_t end = std::min(line.find("  ", begin), line.size());
      cells.push_back(line.substr(begin, end - begin));
      begin = line.find_first_not_of(' ', end);
    }
    rows.push_back(cells);
  }
  return rows;
}

}  // namespace crossgait
